"""What can go wrong with the record."""


class StoreError(Exception):
    """The record cannot be written or read; the message is one sentence with the remedy. It blocks confirming."""


class NoSuchEntry(Exception):
    """An entry that is asked for is not there, or holds no evidence; the message says which."""
