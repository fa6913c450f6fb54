# Positions of the objects in the image of cycles_scene.py: in units of a sphere's radius, in the camera's axes.
import math

PIXELS = 24  # per unit
WIDTH, HEIGHT = 174, 204
TURN, TILT = math.radians(25), math.radians(35)  # the camera's: about +z, and downwards
# Looking along +y, then turned: +x is right, +z is up.
RIGHT = (math.cos(TURN), math.sin(TURN), 0.0)
FORWARD = (-math.sin(TURN) * math.cos(TILT), math.cos(TURN) * math.cos(TILT), -math.sin(TILT))
BACK = tuple(-each for each in FORWARD)
UP = (
    BACK[1] * RIGHT[2] - BACK[2] * RIGHT[1],
    BACK[2] * RIGHT[0] - BACK[0] * RIGHT[2],
    BACK[0] * RIGHT[1] - BACK[1] * RIGHT[0],
)
ROUGHNESS = (0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0)
SPHERES = [("diffuse", 0.0), ("mirror", 0.0)] + [("rough", each) for each in ROUGHNESS]
CENTRES = [((i % 3 - 1) * 2.4, (1 - i // 3) * 2.4 + 0.6) for i in range(9)]
FLOOR_CENTRE, FLOOR_SIZE = (0.0, -3.6), (6.0, 1.4)
