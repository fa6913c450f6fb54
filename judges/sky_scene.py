# Renders Blender's Nishita and Hosek-Wilkie skies as lat-longs whose centre looks towards the sun.
#
#   blender -b -P sky_scene.py -- FOLDER         FOLDER/MODEL_SUN.exr, linear Rec. 709
import math
import os
import sys

import bpy

folder = sys.argv[sys.argv.index("--") + 1]
os.makedirs(folder, exist_ok=True)
SUNS = (60, 30, 10, 5, 2, 0, -4)

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
world = scene.world = bpy.data.worlds.new("sky")
world.use_nodes = True
tree = world.node_tree
sky = tree.nodes.new("ShaderNodeTexSky")
tree.links.new(sky.outputs[0], tree.nodes["Background"].inputs[0])
camera = bpy.data.cameras.new("camera")
camera.type = "PANO"
camera.cycles.panorama_type = "EQUIRECTANGULAR"
eye = bpy.data.objects.new("camera", camera)
eye.rotation_euler = (math.pi / 2, 0, 0)  # along +y, +z up
scene.collection.objects.link(eye)
scene.camera = eye
scene.render.engine = "CYCLES"
scene.cycles.device = "CPU"
scene.cycles.samples = 1
scene.cycles.use_adaptive_sampling = False
scene.cycles.use_denoising = False
scene.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
scene.cycles.filter_width = 0.01
scene.render.resolution_x, scene.render.resolution_y = 256, 128
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
for model in ("NISHITA", "HOSEK_WILKIE"):
    for elevation in SUNS:
        angle = math.radians(elevation)
        sky.sky_type = model
        if model == "NISHITA":  # sea level, its own densities
            sky.sun_disc = False
            sky.sun_elevation, sky.sun_rotation, sky.altitude = angle, 0, 0
        elif elevation < 0:
            continue
        else:
            sky.sun_direction = (0, math.cos(angle), math.sin(angle))
            sky.turbidity, sky.ground_albedo = 3, 0.1
        scene.render.filepath = os.path.abspath(os.path.join(folder, f"{model.lower()}_{elevation}.exr"))
        bpy.ops.render.render(write_still=True)
