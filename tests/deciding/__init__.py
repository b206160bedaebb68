"""The rules of the decision, without viser and without a clock."""
