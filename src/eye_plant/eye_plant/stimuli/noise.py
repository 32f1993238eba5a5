"""Noise with the amplitude spectrum of natural scenes."""

import cv2
import numpy as np


def octaves_noise(random: np.random.Generator, size_px: int) -> np.ndarray:
    """Return noise (size_px, size_px) float32, zero mean, unit variance, spectrum close to 1/f.

    Each octave of spatial frequency has the same variance, which in two dimensions is an amplitude
    proportional to 1/f: white noise of every size from 2 x 2 on, each enlarged to the next.
    """
    noise: np.ndarray = np.zeros((2, 2), np.float32)
    while True:
        white = np.frombuffer(random.bytes(noise.size), np.uint8).reshape(noise.shape)
        noise = noise + (white.astype(np.float32) / np.float32(127.5) - np.float32(1.0))
        if noise.shape[0] == size_px:
            return (noise - noise.mean()) / noise.std()
        next_px = min(2 * noise.shape[0], size_px)
        noise = cv2.resize(noise, (next_px, next_px), interpolation=cv2.INTER_LINEAR)
