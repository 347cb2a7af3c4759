"""What sensors do to what they measure: noise, bias, rate, delay, losses, a clock of their own."""
