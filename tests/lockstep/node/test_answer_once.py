"""AnswerOnce: the verdict on a stamp depends on what was answered last."""

from lockstep.node.answer_once import AnswerOnce, Verdict


def test_all_stamps_are_new_at_first() -> None:
    answers = AnswerOnce()
    assert answers.judge(0) is Verdict.NEW
    assert answers.judge(10**18) is Verdict.NEW


def test_judging_alone_answers_nothing() -> None:
    answers = AnswerOnce()
    answers.judge(7)
    assert answers.judge(7) is Verdict.NEW


def test_the_answered_stamp_is_repeated_and_older_ones_are_old() -> None:
    answers = AnswerOnce()
    answers.answered(7)
    assert answers.judge(6) is Verdict.OLD
    assert answers.judge(7) is Verdict.REPEATED
    assert answers.judge(7) is Verdict.REPEATED
    assert answers.judge(8) is Verdict.NEW


def test_reset_forgets() -> None:
    answers = AnswerOnce()
    answers.answered(7)
    answers.reset()
    assert answers.judge(0) is Verdict.NEW
