"""Hindsight regression in one file, written from docs/model/hindsight.md and nothing else.

    .venv/bin/python docs/examples/hindsight.py      # a toy eye learns to turn; a few seconds

Slow and plain; the product's own rule is vergence_rl.hindsight. Both give the same commands, which
tests/vergence_rl/hindsight/test_from_the_page.py checks. Numbers of equations are the page's.
"""

import hashlib
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Settings:
    """The parameters of the rule by the page's names; the defaults are those of `precise`."""

    n_episode: int = 10
    p: float = 0.5
    sd: float = 0.02
    bias: float = 0.02
    v0: float = 2.5e-4
    tau: float = 0.005
    k: float = 0.0  # above 0: lengths in units of the present noise
    rho: float = 0.01
    rho_samples: float = 0.0
    rho_own: float = 1.0
    memory: float = 0.5
    least_memory: float = 1000.0
    period: int = 100
    n_best: int = 1
    starts: float = 0.0
    floor: float = 0.0


@dataclass
class Sample:
    """One iteration of an episode: state, activations, reward, and the command that led here."""

    s: Floats
    x: Floats
    r: float
    asked: Floats
    e: Floats


class HindsightRegression:
    """Features, activations and reward in, a command out."""

    def __init__(
        self, settings: Settings, seed: int, n_features: int, lowest: Floats, highest: Floats
    ) -> None:
        """lowest, highest: (n_muscles,) limits of the commands."""
        self.c, self.seed, self.lowest, self.highest = settings, seed, lowest, highest
        self.n_muscles, n_entries = len(lowest), n_features + len(lowest)
        self.n_state = n_entries + 1
        self.count, self.mean, self.m2 = 0, np.zeros(n_entries), np.zeros(n_entries)
        self.samples: list[Sample] = []
        self.last: tuple[int, int] | None = None
        self.starts: list[Floats] = []
        self.actor = np.zeros((self.n_muscles, self.n_state))
        self.asked = self.e = np.zeros(self.n_muscles)
        self.first_noise = settings.v0 * np.eye(self.n_muscles)
        self.begin()

    def begin(self) -> None:
        """Eq. 4: sums that know nothing but the first noise."""
        self.noise = self.first_noise.copy()
        self.best_noise = self.first_noise.copy()
        self.weight = self.c.least_memory
        self.ss = np.zeros((self.n_state, self.n_state))
        self.st = np.zeros((self.n_state, self.n_muscles))
        self.tt = self.weight * self.first_noise

    def step(
        self, features: Floats, x: Floats, r: float, iteration: int, n: int, *, training: bool
    ) -> Floats:
        """Return the command (n_muscles,) for an observation; n: training iterations before it."""
        s = self.state(np.concatenate((np.asarray(features, float) ** self.c.p, x)), training)
        if not training:
            self.samples, self.last = [], None
            return self.within(x + self.actor @ s, self.noise)
        if self.last != (iteration - 1, n - 1):
            self.samples, self.asked = [], x
        self.last = iteration, n
        self.samples.append(Sample(s, x, r, self.asked, self.e))
        if len(self.samples) == self.c.n_episode == iteration + 1:
            self.learn(n + 1)
        self.e = root(self.noise) @ draw(self.seed, "exploration", n).normal(size=self.n_muscles)
        self.asked = x + self.actor @ s + self.e
        return self.within(self.asked, self.noise)

    def state(self, entries: Floats, training: bool) -> Floats:
        """Eq. 1: each entry to mean 0 and standard deviation sd, then the bias."""
        if training:
            self.count += 1
            d = entries - self.mean
            self.mean = self.mean + d / self.count
            self.m2 = self.m2 + d * (entries - self.mean)
        s = np.zeros(self.n_state)
        if self.count > 1:
            varies = self.m2 > 0.0
            deviation = np.sqrt(self.m2[varies] / (self.count - 1))
            s[:-1][varies] = self.c.sd * (entries - self.mean)[varies] / deviation
        s[-1] = self.c.bias
        return s

    def learn(self, n: int) -> None:
        """Eqs. 3 to 10, after an episode; n: training iterations so far."""
        c, samples = self.c, self.samples
        if c.starts and len(self.starts) < 10 * self.n_muscles:
            self.starts.append(samples[0].x)
            if len(self.starts) == 10 * self.n_muscles:
                self.first_noise = self.noise_of_starts()
                self.begin()
            return
        order = sorted(range(len(samples)), key=lambda i: -samples[i].r)
        best = self.best_place([samples[i] for i in order[: c.n_best]])
        m = max(c.least_memory, c.memory * n)
        kept = math.exp(-c.n_episode / m)
        self.weight, self.ss, self.st, self.tt = (
            kept * a for a in (self.weight, self.ss, self.st, self.tt)
        )
        for v in samples:
            t = self.target(best, v) if c.n_best == 1 else best - v.x
            w = self.nearness(best - v.x)
            self.weight += w
            self.ss += w * np.outer(v.s, v.s)
            self.st += w * np.outer(v.s, t)
            self.tt += w * np.outer(t, t)
        if c.n_best > 1:  # eq. 9; nobody's noise led to the first place
            led = [samples[i] for i in order if i > 0][: c.n_best]
            tried = [self.within(v.asked, self.noise) for v in led]
            meant = [self.within(v.asked - v.e, self.noise) for v in led]
            e = np.array(tried) - np.array(meant)
            self.best_noise = kept * self.best_noise + (1 - kept) * (ranks(c.n_best) * e.T) @ e
        if n % c.period == 0:
            self.solve(m)

    def solve(self, m: float) -> None:
        """Eqs. 6 to 8: the actor, and from what it leaves unexplained the noise."""
        c = self.c
        shares = np.full(self.n_state, c.rho + c.rho_samples / m)
        shares[-self.n_muscles - 1 :] *= c.rho_own
        ridge = np.diag(shares * np.trace(self.ss) / self.n_state)
        self.actor = np.linalg.solve(self.ss + ridge, self.st).T
        explained = self.actor @ self.st
        left = self.tt - explained - explained.T + self.actor @ self.ss @ self.actor.T
        self.noise = self.best_noise.copy() if c.n_best > 1 else left / self.weight
        self.noise = (self.noise + self.noise.T) / 2
        if c.floor:  # eq. 10
            r = c.floor * root(self.first_noise)
            ratios, axes = np.linalg.eigh(np.linalg.solve(r, np.linalg.solve(r, self.noise).T))
            axes = r @ axes
            self.noise = (axes * np.maximum(ratios, 1.0)) @ axes.T

    def best_place(self, best: list[Sample]) -> Floats:
        """Eq. 2: the best sample's activations, or the mean of the best ones by rank."""
        a = ranks(self.c.n_best)
        place = a @ np.array([v.x for v in best])
        asked = a @ np.array([v.asked for v in best])
        beyond = (asked < self.lowest) | (asked > self.highest)
        return place if self.c.n_best == 1 else made_up(place, asked, self.noise, beyond)

    def target(self, best: Floats, v: Sample) -> Floats:
        """Eq. 3: from a sample to the best place, or beyond a limit if the actor's command is."""
        wanted = v.x + self.actor @ v.s
        beyond = ((best <= self.lowest) & (wanted < self.lowest)) | (
            (best >= self.highest) & (wanted > self.highest)
        )
        return made_up(best, wanted, self.noise, beyond) - v.x

    def nearness(self, t: Floats) -> float:
        """Eq. 5: the weight of a target by its distance."""
        n = self.n_muscles
        if self.c.k:
            unit = root(self.noise + 1e-6 * np.trace(self.noise) / n * np.eye(n))
            return self.c.k**2 / (self.c.k**2 + np.sum(np.linalg.solve(unit, t) ** 2))
        unit = root(self.first_noise) / math.sqrt(self.c.v0)
        return self.c.tau**2 / (self.c.tau**2 + np.sum(np.linalg.solve(unit, t) ** 2))

    def noise_of_starts(self) -> Floats:
        """Eq. 11: the covariance of the first activations, smaller."""
        starts, n = np.array(self.starts), self.n_muscles
        covariance = np.cov(starts.T, bias=True)
        covariance += 1e-6 * (np.trace(covariance) / n + self.c.v0) * np.eye(n)
        return self.c.starts**2 * covariance

    def within(self, asked: Floats, covariance: Floats) -> Floats:
        """The allowed command nearest to the asked one, measured in the noise."""
        if ((asked >= self.lowest) & (asked <= self.highest)).all():
            return asked
        whiten = np.linalg.inv(root(covariance))
        bounds = (self.lowest, self.highest)
        return lsq_linear(whiten, whiten @ asked, bounds, method="bvls", tol=1e-15).x


def made_up(free: Floats, at: Floats, covariance: Floats, held: NDArray[np.bool_]) -> Floats:
    """Held entries as in `at`; the others follow from `free` as the covariance lets one expect."""
    found = np.where(held, at, free)
    if held.any() and not held.all():
        rest = covariance[np.ix_(~held, held)]
        found[~held] += rest @ np.linalg.solve(covariance[np.ix_(held, held)], (at - free)[held])
    return found


def ranks(n_best: int) -> Floats:
    """Weights of the best samples, the best one first; they add up to 1."""
    a = math.log(n_best + 0.5) - np.log(np.arange(1, n_best + 1))
    return np.asarray(a / a.sum())


def root(covariance: Floats) -> Floats:
    """The symmetric square root."""
    variances, axes = np.linalg.eigh(covariance)
    return (axes * np.sqrt(np.maximum(variances, 0.0))) @ axes.T


def draw(seed: int, role: str, number: int) -> np.random.Generator:
    """The generator of one draw: a function of its arguments."""
    key = np.frombuffer(hashlib.blake2b(f"{seed}/{role}".encode(), digest_size=16).digest(), "<u8")
    return np.random.Generator(np.random.Philox(key=key, counter=[0, number, 0, 0]))


def main() -> None:
    """A toy eye, turned by two muscles, sees how far it is from an object, with noise."""
    rule = HindsightRegression(Settings(), 1, 8, np.zeros(2), np.array([0.2, 0.1]))
    tuning = np.linspace(-4.0, 4.0, 8)
    for n in range(20_000):
        iteration = n % 10
        if iteration == 0:
            random = np.random.default_rng(n)
            x, wanted_deg = random.uniform(0, [0.2, 0.1]), random.uniform(0.5, 6.4)
        error_deg = wanted_deg - (1.0 + 75.0 * x[0] - 82.0 * x[1])
        if n % 2_000 == 9:
            print(f"episode {n // 10:5d}: ends {abs(error_deg):.3f} deg off")
        seen = np.exp(-((error_deg - tuning) ** 2)) + 0.01 * random.random(8)
        x = rule.step(seen, x, -min(abs(error_deg), 1.5), iteration, n, training=True)


if __name__ == "__main__":
    main()
