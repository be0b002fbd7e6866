"""GPU passes: each reads named targets and writes named targets."""
