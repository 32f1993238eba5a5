"""MuJoCo's own functions, called in compiled loops: from Python the calls cost as much as the work.

model and data are addresses, as MjModel and MjData give them; arrays are views of what MuJoCo keeps
in data, and change with it.
"""

import ctypes

import mujoco
import numpy as np
from llvmlite import binding
from numba import float64, njit, types, void
from numpy.typing import NDArray

Array = NDArray[np.float64]

_N_EYES, _N_AXES = 2, 3
_PROBE_RAD = 1e-6
_REACH_RAD = 0.2
# Steps above it are taken along the stiffness found there, the last ones along an estimate.
_NEAR_RAD = 0.02
_CONVERGED_RAD = 1e-13
_MAX_ITERATIONS = 100

# Whose functions are those of the library that it was loaded with, wherever its file lies.
_BINDINGS = ctypes.CDLL(mujoco._functions.__file__)
_ADDRESSES = types.UniTuple(types.uintp, 2)


def _function(name: str) -> types.ExternalFunction:
    address = ctypes.cast(getattr(_BINDINGS, name), ctypes.c_void_p).value
    binding.add_symbol(name, address)  # so that compiled code finds the same functions
    return types.ExternalFunction(name, void(types.uintp, types.uintp))


_mj_step = _function("mj_step")
_mj_forward = _function("mj_forward")
_mj_kinematics = _function("mj_kinematics")
_mj_com_pos = _function("mj_comPos")
_mj_tendon = _function("mj_tendon")
_mj_transmission = _function("mj_transmission")
_mj_passive = _function("mj_passive")
_mj_fwd_actuation = _function("mj_fwdActuation")


def addresses_of(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[int, int]:
    """Return what MuJoCo's functions are called with; model and data must outlive it."""
    return model._address, data._address


@njit(
    void(
        _ADDRESSES,
        float64[:, :, ::1],
        types.UniTuple(float64[::1], 4),
    ),
    cache=True,
    nogil=True,
)
def step_and_trace(
    model_and_data: tuple[int, int], trace: Array, live: tuple[Array, Array, Array, Array]
) -> None:
    """Step once per row of trace (n_steps, 4, n), and copy the live arrays (n,) to it each time.

    live: activations first, then what mj_step computes from them. A step advances activations and
    leaves the others as they were at its start, so activations are copied before it.
    """
    for i_step in range(trace.shape[0]):
        trace[i_step, 0] = live[0]
        _mj_step(*model_and_data)
        for i in range(1, len(live)):
            trace[i_step, i] = live[i]


@njit(cache=True, nogil=True)
def _find_torque(model_and_data, forces, torque):  # type: ignore[no-untyped-def]
    """Fill torque (6,) about the joints at rest: of mj_forward, what makes forces."""
    _mj_kinematics(*model_and_data)
    _mj_com_pos(*model_and_data)
    _mj_tendon(*model_and_data)
    _mj_transmission(*model_and_data)
    _mj_passive(*model_and_data)
    _mj_fwd_actuation(*model_and_data)
    passive, active = forces
    for i in range(torque.size):
        torque[i] = passive[i] + active[i]


@njit(cache=True, nogil=True)
def _probe_stiffness(model_and_data, forces, angles, torque, stiffness):  # type: ignore[no-untyped-def]
    """Fill stiffness (2, 3, 3), -d torque / d angle, by differences from torque (6,).

    The eyes share no tissue, so one evaluation probes the same axis of both.
    """
    probed = np.empty_like(torque)
    for i_axis in range(_N_AXES):
        left, right = angles[i_axis], angles[_N_AXES + i_axis]
        angles[i_axis] += _PROBE_RAD
        angles[_N_AXES + i_axis] += _PROBE_RAD
        _find_torque(model_and_data, forces, probed)
        angles[i_axis], angles[_N_AXES + i_axis] = left, right
        for i in range(torque.size):
            stiffness[i // _N_AXES, i % _N_AXES, i_axis] = (torque[i] - probed[i]) / _PROBE_RAD


@njit(cache=True, nogil=True)
def _solve(matrix, right):  # type: ignore[no-untyped-def]
    """Return the solution of three equations, by Cramer's rule; zeros where there is none."""
    a, b, c = matrix[:, 0], matrix[:, 1], matrix[:, 2]
    across = np.empty(3)
    solution = np.empty(3)
    _cross(b, c, across)
    determinant = a[0] * across[0] + a[1] * across[1] + a[2] * across[2]
    if determinant == 0.0:
        solution[:] = 0.0
        return solution
    solution[0] = (right[0] * across[0] + right[1] * across[1] + right[2] * across[2]) / determinant
    _cross(right, c, across)
    solution[1] = (a[0] * across[0] + a[1] * across[1] + a[2] * across[2]) / determinant
    _cross(b, right, across)
    solution[2] = (a[0] * across[0] + a[1] * across[1] + a[2] * across[2]) / determinant
    return solution


@njit(cache=True, nogil=True)
def _cross(a, b, product):  # type: ignore[no-untyped-def]
    product[0] = a[1] * b[2] - a[2] * b[1]
    product[1] = a[2] * b[0] - a[0] * b[2]
    product[2] = a[0] * b[1] - a[1] * b[0]


@njit(cache=True, nogil=True)
def _creep(stiffness, torque, step, is_at_rest):  # type: ignore[no-untyped-def]
    """Fill the next step (6,), each eye's slowed by its own torque; return its largest angle.

    is_at_rest (2,): eyes that have converged, to which it adds. The other eye may need more steps;
    meanwhile rounding amends the stiffness of an eye at rest, and a step along such a stiffness may
    lead anywhere. So an eye at rest stays there.
    """
    largest = 0.0
    for i_eye in range(_N_EYES):
        first = _N_AXES * i_eye
        own = torque[first : first + _N_AXES]
        resisting = stiffness[i_eye] + np.abs(own).max() / _REACH_RAD * np.eye(_N_AXES)
        own_step = _solve(resisting, own)
        own_largest = np.abs(own_step).max()
        if own_largest < _CONVERGED_RAD:
            is_at_rest[i_eye] = True
        elif is_at_rest[i_eye]:
            own_step[:] = 0.0
            own_largest = 0.0
        step[first : first + _N_AXES] = own_step
        largest = max(largest, own_largest)
    return largest


@njit(cache=True, nogil=True)
def _amend_stiffness(stiffness, step, fall):  # type: ignore[no-untyped-def]
    """Let the stiffness (2, 3, 3) explain by how much a step (6,) lowered the torque (6,).

    K <- K + (fall - K step) step^T / |step|^2 for each eye (Broyden 1965).
    """
    for i_eye in range(_N_EYES):
        first = _N_AXES * i_eye
        own = step[first : first + _N_AXES]
        square = (own * own).sum()
        if square > 0.0:
            for i in range(_N_AXES):
                missed = fall[first + i] - (stiffness[i_eye, i] * own).sum()
                for j in range(_N_AXES):
                    stiffness[i_eye, i, j] += missed * own[j] / square


@njit(
    void(_ADDRESSES, types.UniTuple(float64[::1], 2), float64[::1]),
    cache=True,
    nogil=True,
)
def creep_to_rest(
    model_and_data: tuple[int, int], forces: tuple[Array, Array], angles: Array
) -> None:
    """Move angles (6,) to where the forces, passive and active (6,) each, are in balance.

    K being the stiffness and t the torque, a step solves (K + |t| / reach) step = t: an implicit
    Euler step of eyes in honey, whose length stays below the reach. So the search follows the way
    the eyes would creep, to the equilibrium they would find, and ends as Newton's method does.
    data is at rest, velocities of actuators included, with the activations it is to have; it ends
    with everything computed at the angles found.
    """
    torque, before = np.empty_like(angles), np.empty_like(angles)
    step = np.empty_like(angles)
    stiffness = np.empty((_N_EYES, _N_AXES, _N_AXES))
    is_at_rest = np.zeros(_N_EYES, np.bool_)
    largest = np.inf
    _find_torque(model_and_data, forces, torque)
    for _ in range(_MAX_ITERATIONS):
        if largest > _NEAR_RAD:
            _probe_stiffness(model_and_data, forces, angles, torque, stiffness)
        largest = _creep(stiffness, torque, step, is_at_rest)
        angles += step
        if largest < _CONVERGED_RAD:
            break
        before[:] = torque
        _find_torque(model_and_data, forces, torque)
        if largest <= _NEAR_RAD:
            _amend_stiffness(stiffness, step, before - torque)
    _mj_forward(*model_and_data)
