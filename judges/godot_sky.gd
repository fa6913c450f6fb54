# Draws spheres lit by the environment.exr of `welkin bake --for godot` in Godot 3:
#   xvfb-run godot3 -s godot_sky.gd -- IMAGE.exr OUT.png
# A mirror, metals of roughness 0.25, 0.5, 0.75 and 1, and a matte sphere, seen along -z.
extends SceneTree

func _initialize():
	var given = OS.get_cmdline_args()
	var image = Image.new()
	var failed = image.load(given[given.size() - 2])
	print("load: ", failed, " ", image.get_size(), " format ", image.get_format())
	var texture = ImageTexture.new()
	texture.create_from_image(image, Texture.FLAG_FILTER)
	var sky = PanoramaSky.new()
	sky.panorama = texture
	sky.radiance_size = Sky.RADIANCE_SIZE_128
	var environment = Environment.new()
	environment.background_mode = Environment.BG_COLOR_SKY
	environment.background_sky = sky
	environment.background_color = Color(0, 0, 0)
	environment.tonemap_mode = Environment.TONE_MAPPER_LINEAR
	environment.tonemap_exposure = 0.5
	var world = WorldEnvironment.new()
	world.environment = environment
	root.add_child(world)
	for i in range(6):
		var ball = MeshInstance.new()
		ball.mesh = SphereMesh.new()
		ball.mesh.radius = 0.9
		ball.mesh.height = 1.8
		var material = SpatialMaterial.new()
		material.metallic = 1.0 if i < 5 else 0.0
		material.roughness = i * 0.25 if i < 5 else 1.0
		ball.material_override = material
		ball.translation = Vector3(2 * i - 5, 0, 0)
		root.add_child(ball)
	var camera = Camera.new()
	camera.set_orthogonal(2.5, 0.1, 50)
	camera.translation = Vector3(0, 0, 10)
	root.add_child(camera)
	camera.current = true
	OS.window_size = Vector2(960, 200)
	for i in range(5):
		yield(self, "idle_frame")
	var shown = root.get_texture().get_data()
	shown.flip_y()
	print("save: ", shown.save_png(given[given.size() - 1]))
	quit()
