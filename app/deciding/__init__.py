"""The decision as a pure state machine: no viser, no threads, and no clock but that of the events."""
