"""The few of many inputs that do the harm."""

from collections.abc import Callable, Sequence


def smallest(inputs: Sequence[int], bites: Callable[[Sequence[int]], bool]) -> list[int]:
    """Return inputs of which none can be left out, by delta debugging (Zeller, Hildebrandt 2002).

    inputs: which bite together; bites: whether some of them, in their order, still do.
    """
    kept, n_parts = list(inputs), 2
    while len(kept) > 1:
        size = -(-len(kept) // n_parts)
        parts = [kept[start : start + size] for start in range(0, len(kept), size)]
        rests = [[i for i in kept if i not in set(part)] for part in parts]
        # With two parts each rest is the other part.
        candidates = rests if n_parts == 2 else [*parts, *rests]
        found = next((some for some in candidates if bites(some)), None)
        if found is not None:
            n_parts = 2 if found in parts else max(n_parts - 1, 2)
            kept = found
        elif n_parts >= len(kept):
            break
        else:
            n_parts = min(2 * n_parts, len(kept))
    return kept
