"""Hindsight regression, our rule: the way to the best activations of each episode (D12)."""
