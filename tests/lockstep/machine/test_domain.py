"""The ROS domain that the environment names."""

import pytest

from lockstep import InputError
from lockstep.machine.domain import given_domain


@pytest.mark.parametrize(("text", "domain"), [("", None), ("0", 0), ("232", 232)])
def test_a_domain(monkeypatch, text: str, domain: int | None) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", text)
    assert given_domain() == domain


@pytest.mark.parametrize("text", ["²", "٣", "233", "-1", "0x10", " 7"])
def test_what_is_no_domain(monkeypatch, text: str) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", text)
    with pytest.raises(InputError, match="ROS_DOMAIN_ID: expected a whole number 0 to 232, got "):
        given_domain()
