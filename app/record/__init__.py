"""The durable record of what was proposed and decided."""
