"""The distributions that a campaign may declare for a figure, each in one unit."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, model_validator

from safeloc.config import Config

Floats = NDArray[np.float64]


class _Declared(Config):
    model_config = ConfigDict(allow_inf_nan=False)

    unit: str


class Fixed(_Declared):
    """One value for every vehicle."""

    distribution: Literal["fixed"]
    value: float

    @property
    def support(self) -> tuple[float, float]:
        """The least and the greatest value."""
        return self.value, self.value

    @property
    def words(self) -> str:
        """The distribution in words."""
        return f"{self.value:g} {self.unit}"

    def draw(self, rng: np.random.Generator, number: int) -> Floats:
        """Return so many independent draws."""
        del rng
        return np.full(number, self.value)


class _Between(_Declared):
    """Values between two ends."""

    low: float
    high: float

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.low >= self.high:
            raise ValueError(f"low {self.low:g} is not below high {self.high:g}; for one value write fixed.")
        return self

    @property
    def support(self) -> tuple[float, float]:
        """The least and the greatest value."""
        return self.low, self.high

    def _within(self, values: Floats) -> Floats:
        return np.asarray((self.low <= values) & (values <= self.high), dtype=np.float64)


class Uniform(_Between):
    """Every value between two ends alike."""

    distribution: Literal["uniform"]

    @property
    def words(self) -> str:
        """The distribution in words."""
        return f"uniform from {self.low:g} to {self.high:g} {self.unit}"

    def draw(self, rng: np.random.Generator, number: int) -> Floats:
        """Return so many independent draws."""
        return rng.uniform(self.low, self.high, number)

    def density(self, values: Floats) -> Floats:
        """Return the probability density at values."""
        return self._within(values) / (self.high - self.low)


class Normal(_Declared):
    """A normal distribution cut off at two ends: what lies beyond them is drawn again."""

    distribution: Literal["normal"]
    mean: float
    deviation: float = Field(gt=0)
    low: float
    high: float

    @model_validator(mode="after")
    def _can_be_drawn(self) -> Normal:
        if not self.low <= self.mean <= self.high or self.low >= self.high:
            raise ValueError(f"the mean {self.mean:g} must lie between low {self.low:g} and high {self.high:g}.")
        return self

    @property
    def support(self) -> tuple[float, float]:
        """The least and the greatest value."""
        return self.low, self.high

    @property
    def words(self) -> str:
        """The distribution in words."""
        ends = f"between {self.low:g} and {self.high:g} {self.unit}"
        return f"normal, mean {self.mean:g}, standard deviation {self.deviation:g}, {ends}"

    def draw(self, rng: np.random.Generator, number: int) -> Floats:
        """Return so many independent draws."""
        found = rng.normal(self.mean, self.deviation, number)
        while (beyond := (found < self.low) | (found > self.high)).any():
            found[beyond] = rng.normal(self.mean, self.deviation, int(beyond.sum()))
        return found

    def density(self, values: Floats) -> Floats:
        """Return the probability density at values."""
        low, high = ((one - self.mean) / self.deviation for one in (self.low, self.high))
        at = (values - self.mean) / self.deviation
        within = (math.erf(high / math.sqrt(2)) - math.erf(low / math.sqrt(2))) / 2
        bell = np.exp(-at * at / 2) / (math.sqrt(2 * math.pi) * self.deviation * within)
        return np.where((low <= at) & (at <= high), bell, 0.0)


class LogUniform(_Between):
    """The logarithm is uniform: as often between 1 and 10 as between 10 and 100."""

    distribution: Literal["log-uniform"]
    low: float = Field(gt=0)

    @property
    def words(self) -> str:
        """The distribution in words."""
        return f"log-uniform from {self.low:g} to {self.high:g} {self.unit}"

    def draw(self, rng: np.random.Generator, number: int) -> Floats:
        """Return so many independent draws."""
        return np.exp(rng.uniform(np.log(self.low), np.log(self.high), number))

    def density(self, values: Floats) -> Floats:
        """Return the probability density at values; rounding may put a draw just beyond an end, which has the density of that end."""
        inside = np.clip(values, self.low, self.high)
        far = np.abs(values - inside) > 1e-9 * self.high
        return np.where(far, 0.0, 1 / (inside * math.log(self.high / self.low)))


class Choice(_Declared):
    """One of several values; alike, or with shares that sum to 1."""

    distribution: Literal["choice"]
    values: tuple[float, ...] = Field(min_length=1)
    shares: tuple[float, ...] = ()

    @model_validator(mode="after")
    def _shares_fit(self) -> Choice:
        if self.shares and (len(self.shares) != len(self.values) or min(self.shares) < 0):
            raise ValueError(
                f"{len(self.shares)} shares for {len(self.values)} values; give each a share of 0 or more."
            )
        if self.shares and abs(sum(self.shares) - 1) > 1e-9:
            raise ValueError(f"the shares sum to {sum(self.shares):g}; they must sum to 1.")
        return self

    @property
    def support(self) -> tuple[float, float]:
        """The least and the greatest value."""
        return min(self.values), max(self.values)

    @property
    def words(self) -> str:
        """The distribution in words."""
        values = ", ".join(f"{value:g}" for value in self.values)
        shares = f" with shares {', '.join(f'{share:g}' for share in self.shares)}" if self.shares else ""
        return f"one of {values} {self.unit}{shares}"

    def draw(self, rng: np.random.Generator, number: int) -> Floats:
        """Return so many independent draws."""
        return rng.choice(np.array(self.values, dtype=np.float64), number, p=self.shares or None)

    def density(self, values: Floats) -> Floats:
        """Return the probability of each value."""
        shares = self.shares or (1 / len(self.values),) * len(self.values)
        found = np.zeros(len(values))
        for value, share in zip(self.values, shares, strict=True):
            found += share * (values == value)
        return found


Distribution = Annotated[Fixed | Uniform | Normal | LogUniform | Choice, Field(discriminator="distribution")]
