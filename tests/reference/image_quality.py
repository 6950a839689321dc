#!/usr/bin/env python3
"""Takes the figures that rilievo/measure/ssim_test.cpp and psnr_test.cpp hold, from scikit-image.

    /usr/bin/python3 tests/reference/image_quality.py      (Debian: python3-skimage, 0.19.3)

The images are the tests' own: quality_test_images.h makes the same ones, with the same integers.
"""

import numpy as np
from skimage.metrics import peak_signal_noise_ratio, structural_similarity


def scramble(x, y, c, seed):
    """A hash of four integers in 32 bits (lowbias32)."""
    h = (x * 73856093 ^ y * 19349663 ^ c * 83492791 ^ seed * 2654435761) & 0xFFFFFFFF
    h ^= h >> 16
    h = h * 0x7FEB352D & 0xFFFFFFFF
    h ^= h >> 15
    h = h * 0x846CA68B & 0xFFFFFFFF
    return h ^ h >> 16


def pair(width, height, seed):
    """Blocks of 8 pixels with a gradient; and the same with noise and some other blocks."""
    y, x, c = np.meshgrid(np.arange(height, dtype=np.uint64), np.arange(width, dtype=np.uint64),
                          np.arange(3, dtype=np.uint64), indexing="ij")
    a = (scramble(x >> 3, y >> 3, c, seed) % 200 + (x + 2 * y) % 56).astype(np.int64)
    noise = scramble(x, y, c, seed + 1) % 31
    changed = scramble(x >> 4, y >> 4, 0 * c, seed + 2) % 8 == 0
    b = np.clip(a + noise.astype(np.int64) - 15 + 60 * changed, 0, 255)
    return a.astype(np.uint8), b.astype(np.uint8)


def luma(image):
    return image.astype(np.float64) @ np.array([0.299, 0.587, 0.114])


if __name__ == "__main__":
    for width, height, seed in ((64, 48, 1), (131, 77, 2), (11, 11, 3), (320, 180, 4)):
        a, b = pair(width, height, seed)
        s = structural_similarity(luma(a), luma(b), gaussian_weights=True, sigma=1.5,
                                  use_sample_covariance=False, data_range=255)
        p = peak_signal_noise_ratio(a, b, data_range=255)
        print(f"{{{width}, {height}, {seed}, {p:.12f}, {s:.12f}}},")
