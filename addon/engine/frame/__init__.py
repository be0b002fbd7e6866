"""A frame in the making: its passes in order, its sums, its pictures."""
