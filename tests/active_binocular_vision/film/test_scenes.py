"""Which episodes a film shows."""

from active_binocular_vision.film.scenes import RecordedEpisode, chosen_stages


def _episode(training_iteration: int, trial: int, start_error_deg: float) -> RecordedEpisode:
    return RecordedEpisode(training_iteration, trial >= 0, trial, start_error_deg)


def _chosen(episodes: list[RecordedEpisode]) -> list[tuple[str, list[int]]]:
    return [(caption, [e.trial for e in its]) for caption, its in chosen_stages(episodes)]


def test_the_same_trials_before_and_after_and_what_is_there_between() -> None:
    episodes = [_episode(0, trial, trial - 3.0) for trial in (0, 1, 4, 5, 6)]
    episodes += [_episode(100 * n, -1, 1.0) for n in (1, 2, 3, 4, 5)]
    episodes += [_episode(900, trial, trial - 3.0) for trial in (1, 4, 5, 6)]
    assert _chosen(episodes) == [
        ("before learning", [1, 5, 6]),
        ("after 100 training iterations", [-1]),
        ("after 300 training iterations", [-1]),
        ("after 500 training iterations", [-1]),
        ("after 900 training iterations", [1, 5, 6]),
    ]


def test_an_episode_without_a_start_error_has_nothing_to_show() -> None:
    episodes = [_episode(0, 0, 0.2), _episode(0, 1, -2.0)]
    assert _chosen(episodes) == [("before learning", [1])]


def test_where_no_episode_starts_with_an_error_all_are_shown() -> None:
    assert _chosen([_episode(7, 0, 0.0)]) == [("after 7 training iterations", [0])]


def test_trials_are_shown_rather_than_training() -> None:
    episodes = [_episode(0, 2, 1.0), _episode(0, -1, 2.0), _episode(50, -1, 2.0)]
    assert _chosen(episodes) == [("before learning", [2]), ("after 50 training iterations", [-1])]
