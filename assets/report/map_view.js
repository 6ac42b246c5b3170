// The map of report.html in 3D: points, plane patches, camera path and objects, to turn and zoom.
import {
  AmbientLight, BoxGeometry, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide,
  EdgesGeometry, Group, Line, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, Path, PerspectiveCamera, Points, PointsMaterial, Quaternion, Scene, Shape,
  ShapeGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const FIELD_OF_VIEW_DEG = 45;
const FRUSTUM_SHARE = 0.07; // of the scene's radius
const DISTANCE = 2.1; // of the first view, in radii
const WILD_SHARE = 0.03; // of the points lie out at either end

function bytesOf(text) {
  return Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
}

function vector(values) {
  return new Vector3(values[0], values[1], values[2]);
}

function cssColor(name) {
  return new Color(getComputedStyle(document.documentElement).getPropertyValue(name).trim());
}

/** Points as stored and in both colourings. */
function readPoints(data) {
  const position = new Float32Array(bytesOf(data.points.position).buffer);
  const seen = bytesOf(data.points.color);
  const plane = new Int16Array(bytesOf(data.points.plane).buffer);
  const ofPlane = new Map(data.planes.map((p) => [p.id, new Color(p.color)]));
  const byPlane = new Float32Array(position.length);
  const asSeen = new Float32Array(position.length);
  const none = new Color("#969696");
  const color = new Color();
  for (let i = 0; i < plane.length; ++i) {
    (ofPlane.get(plane[i]) ?? none).toArray(byPlane, 3 * i);
    color.setRGB(seen[3 * i] / 255, seen[3 * i + 1] / 255, seen[3 * i + 2] / 255, "srgb");
    color.toArray(asSeen, 3 * i);
  }
  return { position, plane, byPlane, asSeen };
}

/** A polygon with holes in its plane's frame, set into the world. */
function patchOf(plane) {
  const shape = new Shape(plane.outer.map((p) => new Vector2(p[0], p[1])));
  shape.holes = plane.holes.map((hole) => new Path(hole.map((p) => new Vector2(p[0], p[1]))));
  const fill = new Mesh(
    new ShapeGeometry(shape),
    new MeshBasicMaterial({ color: plane.color, side: DoubleSide, transparent: true, opacity: 0.28,
                            depthWrite: false }));
  const ring = [...plane.outer, plane.outer[0]].map((p) => new Vector3(p[0], p[1], 0));
  const edge = new Line(new BufferGeometry().setFromPoints(ring),
                        new LineBasicMaterial({ color: plane.color }));
  const patch = new Group();
  patch.add(fill, edge);
  const x = vector(plane.x);
  const y = vector(plane.y);
  patch.applyMatrix4(new Matrix4().makeBasis(x, y, x.clone().cross(y))
    .setPosition(vector(plane.origin)));
  patch.userData = { plane: plane.id, fill };
  return patch;
}

/** Pieces of the path, broken where frames have no pose. */
function pathOf(data, material) {
  const pairs = [];
  let last = null;
  for (const pose of data.frames.pose) {
    if (pose && last) pairs.push(vector(last), vector(pose));
    last = pose;
  }
  return new LineSegments(new BufferGeometry().setFromPoints(pairs), material);
}

function keyframesOf(data, material) {
  const of = new Map(data.frames.index.map((index, i) => [index, data.frames.pose[i]]));
  const places = data.keyframes.map((index) => of.get(index)).filter(Boolean).map(vector);
  return new Points(new BufferGeometry().setFromPoints(places), material);
}

/** The camera as a pyramid that looks along +z; y points down as in the pictures. */
function frustumOf(camera, depth, material) {
  const corner = (x, y) =>
    new Vector3(((x - camera.cx) / camera.fx) * depth, ((y - camera.cy) / camera.fy) * depth, depth);
  const c = [corner(0, 0), corner(camera.width, 0), corner(camera.width, camera.height),
             corner(0, camera.height)];
  const eye = new Vector3();
  const lines = [];
  for (let i = 0; i < 4; ++i) lines.push(eye, c[i], c[i], c[(i + 1) % 4]);
  return new LineSegments(new BufferGeometry().setFromPoints(lines), material);
}

/** The model itself where the page carries it. */
function modelOf(mesh) {
  const geometry = new BufferGeometry();
  const color = Float32Array.from(bytesOf(mesh.color), (c) => (c / 255) ** 2.2);
  geometry.setAttribute("position",
                        new BufferAttribute(new Float32Array(bytesOf(mesh.position).buffer), 3));
  geometry.setAttribute("color", new BufferAttribute(color, 3));
  geometry.setIndex(new BufferAttribute(new Uint32Array(bytesOf(mesh.triangles).buffer), 1));
  return new Mesh(geometry, new MeshLambertMaterial({ vertexColors: true, flatShading: true,
                                                      side: DoubleSide }));
}

function objectOf(object, material) {
  const low = vector(object.min);
  const size = vector(object.max).sub(low);
  const geometry = new BoxGeometry(size.x, size.y, size.z);
  geometry.translate(low.x + size.x / 2, low.y + size.y / 2, low.z + size.z / 2);
  const box = new Group();
  box.add(new LineSegments(new EdgesGeometry(geometry), material));
  if (object.mesh) box.add(modelOf(object.mesh));
  box.applyMatrix4(new Matrix4().fromArray(object.matrix));
  return box;
}

/** Middle and reach of the camera's path and of the points but for the wild ones. */
function extentOf(data, points) {
  const path = data.frames.pose.filter(Boolean);
  const low = new Vector3();
  const high = new Vector3();
  ["x", "y", "z"].forEach((axis, k) => {
    const seen = [...points.position.filter((_, i) => i % 3 === k)].sort((a, b) => a - b);
    const ends = path.map((pose) => pose[k]);
    if (seen.length > 0) {
      ends.push(seen[Math.floor(WILD_SHARE * (seen.length - 1))],
                seen[Math.ceil((1 - WILD_SHARE) * (seen.length - 1))]);
    }
    low[axis] = ends.reduce((a, b) => Math.min(a, b), ends[0] ?? 0);
    high[axis] = ends.reduce((a, b) => Math.max(a, b), ends[0] ?? 0);
  });
  const middle = low.clone().add(high).multiplyScalar(0.5);
  return { middle, radius: high.distanceTo(middle) || 1 };
}

/** From behind and above the cameras' mean view. */
function firstView(data, up) {
  const ahead = new Vector3();
  for (const pose of data.frames.pose.filter(Boolean)) {
    ahead.add(new Vector3(0, 0, 1).applyQuaternion(new Quaternion().fromArray(pose, 3)));
  }
  ahead.addScaledVector(up, -ahead.dot(up));
  if (ahead.length() < 1e-6) ahead.set(up.y, up.z, up.x).cross(up);
  const aside = ahead.clone().normalize().cross(up);
  return ahead.normalize().multiplyScalar(-0.8).addScaledVector(aside, 0.45)
    .addScaledVector(up, 0.62).normalize();
}

class MapView {
  constructor(place, data) {
    this.data = data;
    const canvas = document.createElement("canvas");
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-label", "Map in 3D. Arrow keys turn it, plus and minus zoom, 0 resets.");
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.scene = new Scene();
    this.up = vector(data.up).normalize();
    this.points = readPoints(data);
    this.extent = extentOf(data, this.points);
    this.build();
    this.aim();
    this.controls = new OrbitControls(this.camera, canvas);
    canvas.style.touchAction = "pan-y";
    this.controls.target.copy(this.extent.middle);
    this.controls.addEventListener("change", () => this.draw());
    this.controls.update();
    place.replaceChildren(canvas, this.tools());
    canvas.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.fit()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.recolor());
    this.recolor();
    this.fit();
  }

  build() {
    const { data, points } = this;
    this.ink = new LineBasicMaterial();
    this.accent = new LineBasicMaterial();
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(points.position, 3));
    geometry.setAttribute("color", new BufferAttribute(points.byPlane, 3));
    this.dots = new PointsMaterial({ size: 2, sizeAttenuation: false, vertexColors: true });
    this.stations = new PointsMaterial({ size: 5, sizeAttenuation: false });
    const patches = new Group();
    patches.add(...data.planes.filter((p) => p.outer.length > 2).map(patchOf));
    const path = new Group();
    this.frustum = frustumOf(data.camera, FRUSTUM_SHARE * this.extent.radius, this.accent);
    path.add(pathOf(data, this.ink), keyframesOf(data, this.stations), this.frustum);
    const objects = new Group();
    objects.add(...data.objects.map((object) => objectOf(object, this.accent)));
    this.layers = { Points: new Points(geometry, this.dots), Planes: patches, Path: path,
                    Objects: objects };
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.copy(this.up).addScaledVector(firstView(data, this.up), 0.7);
    this.scene.add(...Object.values(this.layers), sun, new AmbientLight(0xffffff, 1.3));
  }

  aim() {
    const { middle, radius } = this.extent;
    this.camera ??= new PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, radius / 200, radius * 50);
    this.camera.up.copy(this.up);
    this.camera.position.copy(middle).addScaledVector(firstView(this.data, this.up), DISTANCE * radius);
    this.camera.lookAt(middle);
  }

  tools() {
    const bar = document.createElement("div");
    bar.className = "map-tools";
    const button = (name, pressed, action) => {
      const made = document.createElement("button");
      made.type = "button";
      made.textContent = name;
      if (pressed !== null) made.setAttribute("aria-pressed", String(pressed));
      made.addEventListener("click", () => {
        if (pressed !== null) {
          made.setAttribute("aria-pressed", String(made.getAttribute("aria-pressed") !== "true"));
        }
        action(made.getAttribute("aria-pressed") === "true");
        this.draw();
      });
      bar.append(made);
    };
    for (const [name, layer] of Object.entries(this.layers)) {
      if (name === "Objects" && layer.children.length === 0) continue;
      button(name, true, (on) => { layer.visible = on; });
    }
    button("Colours by plane", true, (on) => {
      const geometry = this.layers.Points.geometry;
      const { byPlane, asSeen } = this.points;
      geometry.setAttribute("color", new BufferAttribute(on ? byPlane : asSeen, 3));
    });
    button("From above", null, () => this.fromAbove());
    button("Reset view", null, () => this.reset());
    return bar;
  }

  reset() {
    this.aim();
    this.controls.target.copy(this.extent.middle);
    this.controls.update();
  }

  fromAbove() {
    const { middle, radius } = this.extent;
    const back = firstView(this.data, this.up);
    this.camera.position.copy(middle).addScaledVector(this.up, DISTANCE * radius)
      .addScaledVector(back, 0.01 * radius);
    this.controls.target.copy(middle);
    this.controls.update();
  }

  turn(left, over) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    offset.applyAxisAngle(this.up, left);
    const aside = this.up.clone().cross(offset).normalize();
    const raised = offset.clone().applyAxisAngle(aside, over);
    const steep = Math.abs(raised.clone().normalize().dot(this.up));
    this.camera.position.copy(this.controls.target).add(steep < 0.999 ? raised : offset);
    this.controls.update();
  }

  zoom(factor) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    this.camera.position.copy(this.controls.target).addScaledVector(offset, factor);
    this.controls.update();
  }

  key(event) {
    const step = 0.12;
    const actions = {
      ArrowLeft: () => this.turn(-step, 0), ArrowRight: () => this.turn(step, 0),
      ArrowUp: () => this.turn(0, -step), ArrowDown: () => this.turn(0, step),
      "+": () => this.zoom(0.9), "=": () => this.zoom(0.9), "-": () => this.zoom(1.1),
      0: () => this.reset(),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
    this.draw();
  }

  recolor() {
    this.ink.color = cssColor("--ink");
    this.accent.color = cssColor("--accent");
    this.stations.color = cssColor("--ink");
    this.draw();
  }

  fit() {
    const canvas = this.renderer.domElement;
    const ratio = Math.min(window.devicePixelRatio, 2);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(canvas.clientWidth, canvas.clientHeight, false);
    this.dots.size = 2 * ratio;
    this.stations.size = 5 * ratio;
    this.camera.aspect = canvas.clientWidth / Math.max(canvas.clientHeight, 1);
    // A narrow picture has to hold the map's width too.
    const half = (FIELD_OF_VIEW_DEG * Math.PI) / 360;
    this.camera.fov = this.camera.aspect >= 1
      ? FIELD_OF_VIEW_DEG
      : (360 / Math.PI) * Math.atan(Math.tan(half) / this.camera.aspect);
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  setFrame(i) {
    const pose = this.data.frames.pose[i];
    this.frustum.visible = Boolean(pose);
    if (pose) {
      this.frustum.position.copy(vector(pose));
      this.frustum.quaternion.fromArray(pose, 3);
    }
    this.draw();
  }

  highlight(id) {
    for (const patch of this.layers.Planes.children) {
      const own = id === null ? 0.28 : patch.userData.plane === id ? 0.65 : 0.08;
      patch.userData.fill.material.opacity = own;
    }
    this.draw();
  }

  /** At most once a picture of the screen. */
  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.scene, this.camera);
    });
  }
}

export function show(place, data) {
  return new MapView(place, data);
}
