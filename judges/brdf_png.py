# Writes Welkin's BRDF table as the image that Babylon.js reads: python brdf_png.py OUT.png
#
# Red and green are bias and scale + bias to the power of 1/2.2 (RGBD with a divisor of 1), the first row is of roughness 0.
import sys

import numpy as np

import png
import welkin

table = np.asarray(welkin.brdf_table(width=128, height=128, model="multiple-scattering", sheen=True))
png.write(sys.argv[1], np.clip(table, 0, 1) ** (1 / 2.2))
