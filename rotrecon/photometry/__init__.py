"""A fitted surface refined against the pictures themselves: where it says the views agree, they must."""
