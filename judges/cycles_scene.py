# Renders nine spheres and a plane in Blender's Cycles, lit by a folder of `welkin bake --for blender`.
#
#   blender -b --factory-startup -P cycles_scene.py -- FOLDER|white OUT.exr SAMPLES SEED
#
# The world is made by the code that the folder's README.md prints. The image is linear, of 32-bit floats, without any
# filter across pixels; nothing casts shadows or shows in anything else, so a pixel has the light of the environment alone.
# The camera is orthographic: the normal of a pixel is known from its position (layout.py).
import os
import re
import sys

import bpy
from mathutils import Matrix

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import layout  # noqa: E402

folder, output, samples, seed = sys.argv[sys.argv.index("--") + 1 :]

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
if folder == "white":
    world = scene.world = bpy.data.worlds.new("white")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (1, 1, 1, 1)
else:
    with open(os.path.join(folder, "README.md"), encoding="utf-8") as file:
        printed = re.search(r"```python\n(.*?)```", file.read(), re.S).group(1)
    exec(printed.replace("//environment.exr", os.path.join(os.path.abspath(folder), "environment.exr")), {})
    scene.world.cycles.sampling_method = "MANUAL"
    scene.world.cycles.sample_map_resolution = 2048


def sphere_normal(tree):
    """The normal that a perfect sphere has at a pixel, whatever the mesh: x right + y up + sqrt(1 - x^2 - y^2) back."""

    def math(kind, operation, *inputs, output=0):
        node = tree.nodes.new(kind)
        node.operation = operation
        for socket, value in inputs:
            if isinstance(value, (int, float, tuple)):
                node.inputs[socket].default_value = value
            else:
                tree.links.new(value, node.inputs[socket])
        return node.outputs[output]

    vector, scalar = "ShaderNodeVectorMath", "ShaderNodeMath"
    position = tree.nodes.new("ShaderNodeTexCoord").outputs["Object"]
    x, y = (math(vector, "DOT_PRODUCT", (0, position), (1, axis), output=1) for axis in (right, up))
    squares = [math(scalar, "MULTIPLY", (0, each), (1, each)) for each in (x, y)]
    rest = math(scalar, "SUBTRACT", (0, 1.0), (1, math(scalar, "ADD", (0, squares[0]), (1, squares[1]))))
    z = math(scalar, "SQRT", (0, rest))
    parts = [math(vector, "SCALE", (0, axis), (3, each)) for axis, each in ((right, x), (up, y), (back, z))]
    return math(vector, "ADD", (0, math(vector, "ADD", (0, parts[0]), (1, parts[1]))), (1, parts[2]))


def material(kind, roughness):
    made = bpy.data.materials.new(kind)
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    surface = nodes.new("ShaderNodeOutputMaterial")
    if kind in ("diffuse", "floor"):
        shader = nodes.new("ShaderNodeBsdfDiffuse")
    else:
        shader = nodes.new("ShaderNodeBsdfGlossy")
        shader.distribution = "SHARP" if kind == "mirror" else "GGX"
        shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Color"].default_value = (1, 1, 1, 1)
    if kind != "floor":
        made.node_tree.links.new(sphere_normal(made.node_tree), shader.inputs["Normal"])
    made.node_tree.links.new(shader.outputs[0], surface.inputs[0])
    return made


def place(mesh, name, matrix, kind, roughness):
    thing = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(thing)
    thing.matrix_world = matrix
    thing.material_slots[0].link = "OBJECT"
    thing.material_slots[0].material = material(kind, roughness)
    for ray in ("diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(thing, f"visible_{ray}", False)


right, up, back = (layout.RIGHT, layout.UP, layout.BACK)
camera_to_world = Matrix((right, up, back)).transposed().to_4x4()

bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=1.0)
ball = bpy.context.object
bpy.ops.object.shade_smooth()
ball.data.materials.append(None)
for (kind, roughness), (x, y) in zip(layout.SPHERES, layout.CENTRES):
    place(ball.data, f"{kind} {roughness}", Matrix.Translation(camera_to_world @ Matrix.Translation((x, y, 0)).translation), kind, roughness)
floor = bpy.data.meshes.new("floor")  # level: its normal is +z
half = (layout.FLOOR_SIZE[0] / 2, layout.FLOOR_SIZE[1] / 2)
floor.from_pydata([(-half[0], -half[1], 0), (half[0], -half[1], 0), (half[0], half[1], 0), (-half[0], half[1], 0)], [], [(0, 1, 2, 3)])
floor.materials.append(None)
place(floor, "floor", Matrix.Translation(camera_to_world @ Matrix.Translation((*layout.FLOOR_CENTRE, 0)).translation), "floor", 0)
bpy.data.objects.remove(ball)

camera = bpy.data.cameras.new("camera")
camera.type = "ORTHO"
camera.ortho_scale = max(layout.WIDTH, layout.HEIGHT) / layout.PIXELS
eye = bpy.data.objects.new("camera", camera)
scene.collection.objects.link(eye)
eye.matrix_world = camera_to_world @ Matrix.Translation((0, 0, 20))
scene.camera = eye

scene.render.engine = "CYCLES"
scene.cycles.device = "CPU"
scene.cycles.samples = int(samples)
scene.cycles.seed = int(seed)
scene.cycles.use_adaptive_sampling = False
scene.cycles.use_denoising = False
scene.cycles.max_bounces = scene.cycles.diffuse_bounces = scene.cycles.glossy_bounces = 1
scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = 0
scene.cycles.blur_glossy = 0
scene.cycles.light_sampling_threshold = 0
scene.cycles.pixel_filter_type = "BLACKMAN_HARRIS"  # a box is always a pixel wide
scene.cycles.filter_width = 0.01
scene.render.film_transparent = False
scene.render.resolution_x, scene.render.resolution_y = layout.WIDTH, layout.HEIGHT
scene.render.resolution_percentage = 100
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.image_settings.exr_codec = "ZIP"
scene.render.filepath = os.path.abspath(output)
bpy.ops.render.render(write_still=True)
