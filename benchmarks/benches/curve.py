"""How a picture gets better with the number of its samples, and when it is good enough."""

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Curve:
    """How a progressive picture comes nearer to the truth.

    Parameters
    ----------
    samples : tuple of int
    seconds : tuple of float
        Of drawing that many.
    ssim : tuple of float
    """

    samples: tuple[int, ...]
    seconds: tuple[float, ...]
    ssim: tuple[float, ...]


def samples_to_reach(curve, ssim):
    """Return how many samples it takes to reach a structural similarity.

    Between two marks ``log(1 - SSIM)`` is taken to be linear in the logarithm of the number.

    Parameters
    ----------
    curve : Curve
    ssim : float

    Returns
    -------
    samples : float
        Of the last mark if it is not reached.
    reached : bool
    """
    error = np.log(np.maximum(1.0 - np.array(curve.ssim), 1e-12))
    number = np.log(np.array(curve.samples, float))
    wanted = math.log(max(1.0 - ssim, 1e-12))
    if wanted >= error[0]:
        return float(curve.samples[0]), True
    for i in range(1, len(error)):
        if error[i] <= wanted:
            share = (error[i - 1] - wanted) / (error[i - 1] - error[i])
            return float(np.exp(number[i - 1] + share * (number[i] - number[i - 1]))), True
    return float(curve.samples[-1]), False
