extends SceneTree
# Drives the add-on in the real engine, without a window: axes and refusals in lockstep, then the sample for five seconds,
# all of it twice in one process. Exit code 1: a check failed.

const ROUNDS := 2
const REAM_S := 5.0

var _round := 0
var _scene: Node
var _time_s := 0.0
var _uncut := 0  # triangles of the uncut bone; 0: not shown yet
var _failures := []
var _pushed_N := 0.0  # largest force along +y
var _bricks := {}  # arrays by number: without a window the engine keeps none

# The main loop, once a frame: the checks in lockstep first, then the sample. Returns true at the end of the run.
func _idle(delta: float) -> bool:
	if _scene == null:
		_check_session()
		_check_refusals()
		_check_what_moves()
		_check_tools_and_files()
		_check_guidance()
		_scene = load("res://addons/osteon/sample/ream_cup.tscn").instance()
		_bricks.clear()
		_scene.get_node("Bone").connect("failed", self, "_on_failed")
		_scene.get_node("Bone").connect("brick_changed", self, "_on_brick_changed")
		root.add_child(_scene)
		_time_s = 0.0
		_uncut = 0
		return false
	_time_s += delta
	var bone = _scene.get_node("Bone")
	_pushed_N = max(_pushed_N, bone.force().y)
	if _uncut == 0:
		# the surface of the whole bone takes a moment, in a thread at idle priority: the hand waits for it
		_uncut = bone.triangle_count()
		_time_s = 0.0
		_scene.set_process(_uncut > 0)
		return false
	if _time_s < REAM_S:
		return false
	var figures = bone.session.figures()
	print("round %d: %s; %d frames, %.0f mm3, %d triangles, then %d, up to %.1f N" % [_round + 1, bone.session.engine(),
		figures.frame, figures.removed_mm3, _uncut, bone.triangle_count(), _pushed_N])
	_expect(_uncut > 1000, "the bone is shown: %d triangles" % _uncut)
	_expect(bone.triangle_count() > _uncut, "the mesh grows: %d triangles, then %d" % [_uncut, bone.triangle_count()])
	_expect(figures.removed_mm3 > 100.0, "bone is removed: %.1f mm3" % figures.removed_mm3)
	_expect(_pushed_N > 5.0, "the bone pushes the reamer out, along +y: %.1f N" % _pushed_N)
	_check_brick_meshes(bone)
	_scene.free()
	_scene = null
	_pushed_N = 0.0
	_round += 1
	if _round < ROUNDS:
		return false
	for failure in _failures:
		print("failed: ", failure)
	print("all checks hold" if _failures.empty() else "%d checks failed" % _failures.size())
	quit(0 if _failures.empty() else 1)
	return true

func _expect(good: bool, what: String) -> void:
	if not good:
		_failures.append(what)

func _on_failed(text: String) -> void:
	_failures.append("the sample: " + text)

func _on_brick_changed(number: int, arrays: Array) -> void:
	_bricks[number] = arrays

# A session in lockstep on the CPU; `changes` are further or other parameters.
func _open(changes := {}) -> Reference:
	var session = load("res://addons/osteon/osteon_session.gdns").new()
	var params := {"lockstep": true, "engine": "cpu"}
	for key in changes:
		params[key] = changes[key]
	var wrong: String = session.open(params)
	_expect(wrong.empty(), wrong)
	return session

# The proxy follows a tool along and about each of Godot's axes, and the wrench has Godot's axes.
func _check_session() -> void:
	var session := _open()
	var up: Transform = session.approach(0.1)
	_expect(up.origin.distance_to(Vector3(0, 0.1, 0)) < 1e-6, "the cup opens along +y: %s" % up.origin)
	_expect(up.basis.y.distance_to(Vector3(0, -1, 0)) < 1e-6, "the tool's feed is its +y: %s" % up.basis.y)
	_expect(session.step(up, true, 0.001).empty(), session.last_error())
	for axis in 3:
		var moved := up
		moved.origin[axis] += 0.001
		for _i in 20:
			_expect(session.step(moved, false, 0.001).empty(), session.last_error())
		var proxy: Transform = session.figures().proxy
		_expect(proxy.origin.distance_to(moved.origin) < 1e-6, "axis %d: %s is at %s" % [axis, moved.origin, proxy.origin])
		var turned := up
		turned.basis = Basis(Vector3(int(axis == 0), int(axis == 1), int(axis == 2)), 0.01) * up.basis
		for _i in 20:
			_expect(session.step(turned, false, 0.001).empty(), session.last_error())
		proxy = session.figures().proxy
		var apart := (proxy.basis.x - turned.basis.x).length() + (proxy.basis.y - turned.basis.y).length()
		_expect(apart < 1e-5, "turned about axis %d: %s is at %s" % [axis, turned.basis, proxy.basis])
	# beside the cup's centre: the wall on the side of +x pushes back along -x, that of +z along -z
	for axis in [0, 2]:
		_expect(session.step(session.approach(-0.01), false, 0.001).empty(), session.last_error())
		var aside: Transform = session.approach(-0.017)
		aside.origin[axis] += 0.003
		var force := Vector3.ZERO
		for _i in 150:
			_expect(session.step(aside, false, 0.001).empty(), session.last_error())
			force = session.force(aside)[0]
		_expect(force[axis] < -5.0, "pressed along axis %d: %s" % [axis, force])

# A tool that moves into the bone is damped. A bone on a mount gives way, and its pose to draw moves with it.
func _check_what_moves() -> void:
	var session := _open()
	_expect(session.set_compliance({"mount": true, "mount_point_m": Vector3(0, -0.02, 0)}).empty(), session.last_error())
	_expect(session.step(session.approach(0.0), false, 0.001).empty(), session.last_error())
	var pose: Transform = session.approach(-0.0195)
	var force := Vector3.ZERO
	for _i in 300:
		_expect(session.step(pose, false, 0.001).empty(), session.last_error())
		force = session.force(pose)[0]
	var deflection = session.deflection()
	_expect(deflection.gives_way and not deflection.beyond_limit, "the mount moves: %s" % deflection)
	_expect(deflection.mount_m.y < -2e-5, "the bone is pushed down, along -y: %s" % deflection.mount_m)
	_expect(abs(deflection.bone.origin.y - deflection.mount_m.y) < 1e-4, "it is drawn there: %s" % deflection.bone)
	var faster: Vector3 = session.force(pose, Vector3(0, -0.05, 0), Vector3.ZERO)[0]
	_expect(faster.y > force.y + 1.0, "damping: %s, then %s" % [force, faster])
	_expect("mount_damping_ratio" in session.set_compliance({"mount": true, "mount_damping_ratio": 0.001}), session.last_error())
	for wrong in [{"mount": 1}, {"weight": 3.0}, {"mount_point_m": 0.1}, {"period_s": "often"}]:
		_expect(not session.set_compliance(wrong).empty(), "refused: set_compliance(%s)" % wrong)
	_expect(session.set_compliance({}).empty(), session.last_error())
	_expect(not session.deflection().gives_way, "nothing gives way any more")
	_expect(session.force(pose, Vector3.ZERO)[0] == Vector3.ZERO and not session.last_error().empty(), "refused: force of two")

# Changes tools, saves and restores files, and scores.
func _check_tools_and_files() -> void:
	var session := _open()
	var free: Transform = session.approach(0.01)
	_expect(session.step(free, false, 0.001).empty(), session.last_error())
	_expect(session.version().split(".").size() == 3, "the library's version: %s" % session.version())
	_expect(session.bone_warning() == "", "a shipped bone has no warning")
	var file := OS.get_user_data_dir() + "/kept.osp"
	_expect(session.save(file).empty(), session.last_error())
	_expect(session.export_surface(OS.get_user_data_dir() + "/bone.stl").empty(), session.last_error())
	_expect(not session.export_surface("/no/such/folder/bone.stl").empty(), "refused: a folder that is not there")
	_expect(session.change_tool("reamer", 0.048, free).empty(), session.last_error())
	_expect(not session.change_tool("no_such_tool", 0.0, free).empty(), "refused: a tool that is not there")
	_expect(session.restore(file, free).empty(), session.last_error())
	_expect(not session.restore("/no/such/file", free).empty(), "refused: a file that is not there")
	var found = session.assess("", "")
	_expect(found != null and found.removed_mm3 == 0.0 and found.items[0].metric == "axis_error", "a score: %s" % found)
	_expect(session.assess("no_such_plan", "") == null and "no_such_plan" in session.last_error(), session.last_error())

# Guidance pushes a reamer out that is deeper than planned.
func _check_guidance() -> void:
	var script = load("res://addons/osteon/osteon_guidance.gdns")
	var guidance = script.new()
	_expect(guidance.info() == null and guidance.evaluate(Transform(), Vector3(), Vector3(), Vector3(), Vector3()) == null,
		"nothing there")
	for wrong in [{"plan": "no_such_plan"}, {"reamer": 9}, {"reamer": -1}, {"reamer": 0.5}, {"gain": "much"}, {"colour": "red"}]:
		_expect(not guidance.open(wrong).empty() and not guidance.is_open(), "refused: open(%s)" % wrong)
	_expect(guidance.open({}).empty(), guidance.last_error())
	var info = guidance.info()
	_expect(info.reamers.size() == 4 and abs(info.inclination_deg - 40.0) < 1e-6, "the plan: %s" % info)
	var axis: Vector3 = info.cup_axis
	var side := axis.cross(Vector3.RIGHT).normalized()
	var into := Basis(side, -axis, side.cross(-axis))
	var guided
	for i in 400:
		var apex: Vector3 = info.reamers[0].apex + axis * (1e-3 - 1e-5 * i)
		guided = guidance.evaluate(Transform(into, apex), -0.01 * axis, Vector3.ZERO, Vector3.ZERO, Vector3.ZERO)
	_expect(abs(guided.depth_m - 0.003) < 5e-5 and guided.force.dot(axis) > 20.0, "pushed out: %s" % guided)
	_expect(guidance.set_model_age(0.1).empty() and guidance.set_gain(0.5).empty() and guidance.reset().empty(),
		guidance.last_error())
	_expect(not guidance.set_gain(5.0).empty(), "refused: a gain of 5")
	guidance.close()
	_expect(not guidance.is_open(), "closed")

# Wrong parameters and poses give an error text, and nothing crashes.
func _check_refusals() -> void:
	var script = load("res://addons/osteon/osteon_session.gdns")
	for params in [{"scene": "no_such_scene"}, {"scene": "thin_plate", "tool": "no_such_tool"},
			{"scene": "thin_plate", "diameter_m": 7.0}, {"scene": "thin_plate", "diameter_m": NAN},
			{"scene": "thin_plate", "max_force_N": 1e9}, {"max_force_N": "much"}, {"scene": 3}, {"lockstep": "yes"}, {"engine": "steam"},
			{"colour": "red"}, {"config_folder": "/no/such/folder"}, {7: null}]:
		_expect(not script.new().open(params).empty(), "refused: %s" % params)
	_expect("no_such_scene" in script.new().open({"scene": "no_such_scene"}), "a refusal names what was found")
	for wrong in [null, 3, "acetabulum"]:
		_expect(not script.new().open(wrong).empty(), "refused: open(%s)" % str(wrong))
	var closed = script.new()
	_expect(not closed.set_tool_pose(Transform(), true).empty(), "a session that is not open")
	_expect(closed.force(Transform())[0] == Vector3.ZERO, "no force where none is open")
	_expect(closed.surface_changes().empty() and closed.figures() == null and closed.next_event() == null, "nothing there")
	_expect(closed.approach(0.0) == null, "no pose where none is open")
	closed.close()
	var session := _open({"scene": "thin_plate"})
	var up: Transform = session.approach(0.1)
	for pose in [Transform(Basis(Vector3.ZERO, Vector3.ZERO, Vector3.ZERO), Vector3.ZERO), up.scaled(Vector3(-1, 1, 1)),
			Transform(up.basis, Vector3(NAN, 0, 0)), Transform(up.basis, Vector3(INF, 0, 0)), null, 7]:
		_expect(not session.step(pose, true, 0.001).empty(), "refused pose: %s" % str(pose))
	_expect(not session.step(up, true, 7.0).empty(), "refused time")
	_expect(not session.step(up, true).empty(), "refused number of arguments")
	_expect(not session.set_tool_pose(up, true).empty(), "no set_tool_pose in lockstep")
	_expect(not session.undo(up).empty(), "nothing to undo")
	_expect(session.step(up, true, 0.001).empty(), session.last_error())
	# a node that gives way, and one whose figures are refused
	for compliance in [{"mount": true}, {"mount": true, "mount_mass_kg": -1.0}]:
		var scene = load("res://addons/osteon/sample/ream_cup.tscn").instance()
		var bone = scene.get_node("Bone")
		bone.scene_name = "thin_plate"
		bone.compliance = compliance
		root.add_child(scene)
		_expect((bone.session != null) == (compliance.size() == 1), "compliance of a node: %s" % compliance)
		if bone.session != null:
			bone.force()
			_expect(bone.session.deflection().gives_way, "the node's bone gives way")
			bone._process(0.0)
		scene.free()
	# a node with bad properties warns and stays empty
	for property in [["scene_name", "no_such_scene"], ["tool_path", NodePath("nowhere")], ["max_force_N", -1.0],
			["engine", "steam"], ["config_folder", "/no/such/folder"]]:
		var scene = load("res://addons/osteon/sample/ream_cup.tscn").instance()
		var bone = scene.get_node("Bone")
		bone.scene_name = "thin_plate"
		bone.set(property[0], property[1])
		var texts := []
		bone.connect("failed", self, "_keep_text", [texts])
		root.add_child(scene)
		bone._process(0.0)
		scene._process(0.0)
		_expect(texts.size() == 1 and bone.session == null, "refused node: %s: %s" % [property, texts])
		scene.free()

func _keep_text(text: String, texts: Array) -> void:
	texts.append(text)

# Triangles of bricks are wound like those of the engine's own cube, which shows its outside.
func _check_brick_meshes(bone: Node) -> void:
	var cube := _winding(CubeMesh.new().get_mesh_arrays())
	_expect(abs(cube) == 1.0, "the engine's cube: %f" % cube)
	var alike := 0
	var all := 0
	var colours := {}
	var box := AABB()
	for arrays in _bricks.values():
		if arrays.empty():
			continue
		all += 1
		alike += int(_winding(arrays) * cube > 0.9)
		colours[arrays[Mesh.ARRAY_COLOR][0]] = true
	_expect(all > 10 and alike == all, "%d of %d bricks are wound as the engine's cube" % [alike, all])
	_expect(colours.size() >= 2, "tissues have colours of their own: %s" % [colours.keys()])
	var meshes := 0
	for child in bone.get_children():
		if child is MeshInstance and child.mesh.get_surface_count() == 1:
			meshes += 1
			box = child.mesh.get_aabb() if meshes == 1 else box.merge(child.mesh.get_aabb())
	_expect(meshes == all, "each brick is an ArrayMesh: %d of %d" % [meshes, all])
	_expect(box.size.length() > 0.03 and box.size.length() < 0.3, "they are in metres: %s" % box)

# Mean over all triangles of the sign of (cross product · normal of the first corner): 1 or -1.
func _winding(arrays: Array) -> float:
	var positions: PoolVector3Array = arrays[Mesh.ARRAY_VERTEX]
	var normals: PoolVector3Array = arrays[Mesh.ARRAY_NORMAL]
	var indices: PoolIntArray = arrays[Mesh.ARRAY_INDEX]
	var sum := 0.0
	for i in range(0, indices.size(), 3):
		var a := positions[indices[i]]
		sum += sign((positions[indices[i + 1]] - a).cross(positions[indices[i + 2]] - a).dot(normals[indices[i]]))
	return sum / (indices.size() / 3)
