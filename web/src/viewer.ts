/** The replay: runs in one 3-D picture, drawn only when something changed. */
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Clock } from "./clock";
import { button, colour, el, onSchemeChange } from "./dom";
import { Marks } from "./marks3d";
import { MechanismFigure, RobotFigure } from "./robot3d";
import type { Run } from "./run";

export type Preset = "follow" | "top" | "side" | "free";

/** A picture that has not changed for so long stands [ms]. */
const STILL = 250;

/** One run in the picture: the robot, what it opens, and what is drawn over them. */
class Actor {
  readonly robot: RobotFigure;
  readonly mechanism: MechanismFigure | null;
  marks: Marks;

  constructor(
    readonly run: Run,
    private readonly scene: THREE.Scene,
    ghost: boolean,
    private readonly tint: string | undefined,
  ) {
    const paint = { tint, opacity: ghost ? 0.45 : 1 };
    this.robot = new RobotFigure(run.json.scene, paint);
    const m = run.json.scene?.mechanism;
    this.mechanism = m === undefined ? null : new MechanismFigure(m, paint, !ghost);
    this.marks = new Marks(run, tint);
    scene.add(this.robot.root, this.marks.root);
    if (this.mechanism !== null) scene.add(this.mechanism.root);
  }

  repaintMarks(): void {
    this.scene.remove(this.marks.root);
    this.marks = new Marks(this.run, this.tint);
    this.scene.add(this.marks.root);
  }

  show(time: number): void {
    const q = Array.from({ length: this.run.json.joints }, (_, i) => this.run.between(`q${i + 1}`, time));
    this.robot.pose(
      this.run.between("base_x", time),
      this.run.between("base_y", time),
      this.run.between("base_yaw", time),
      q,
    );
    this.mechanism?.open(this.run.between("opening_q", time));
    this.marks.show(time);
  }
}

/** False where the processor paints the picture. */
function hasGraphicsCard(): boolean {
  const gl = document.createElement("canvas").getContext("webgl");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = gl && info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return !/swiftshader|llvmpipe|software|basic render/i.test(name);
}

/** Fewer pixels while a slow computer plays, so that motion stays smooth; all of them when the picture stands. */
class Sharpness {
  private share = 1;
  private between = 1 / 60;
  private before = 0;
  private frames = 0;

  get ratio(): number {
    return Math.min(2, window.devicePixelRatio) * this.share;
  }

  /** Called per picture. @return true if the ratio has changed */
  next(playing: boolean, now: number): boolean {
    const old = this.share;
    const passed = (now - this.before) / 1000;
    this.before = now;
    if (!playing) this.share = 1;
    else {
      this.between += 0.3 * (Math.min(0.1, passed) - this.between);
      if (++this.frames % 4 !== 0) return false;
      // Between 36 and 50 pictures a second nothing changes.
      if (this.between > 1 / 36) this.share = Math.max(0.5, 0.8 * this.share);
      else if (this.between < 1 / 50) this.share = Math.min(1, 1.1 * this.share);
    }
    return this.share !== old;
  }
}

export class Viewer {
  readonly element = el("div", { class: "viewer" });
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(38, 1, 0.05, 60);
  private readonly renderer: THREE.WebGLRenderer | null;
  private readonly controls: OrbitControls | null = null;
  private readonly actors: Actor[];
  private readonly floor = new THREE.Mesh(new THREE.PlaneGeometry(30, 30), new THREE.MeshLambertMaterial());
  private grid = new THREE.GridHelper();
  private readonly presets = new Map<Preset, HTMLButtonElement>();
  private preset: Preset = "follow";
  private readonly sharpness = new Sharpness();
  private readonly sun = new THREE.DirectionalLight("#fff6e8", 1.7);
  /** Without a graphics card, smooth edges and shadows are drawn when the picture stands, and left out in motion. */
  private readonly card = hasGraphicsCard();
  private fine = false;
  private drawn = 0;
  private dirty = true;
  private frames = 0;

  /** @param tints  One colour per run where several are compared */
  constructor(
    runs: Run[],
    private readonly clock: Clock,
    private readonly local: (run: Run, time: number) => number,
    tints?: string[],
  ) {
    this.renderer = this.makeRenderer();
    this.actors = runs.map((run, i) => new Actor(run, this.scene, i > 0, tints?.[i]));
    this.light();
    this.addPresets();
    if (this.renderer === null) {
      this.element.append(
        el(
          "p",
          { class: "soft" },
          "This browser shows no 3-D pictures (WebGL is switched off). The plots below have everything else.",
        ),
      );
      return;
    }
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("start", () => this.mark("free"));
    this.controls.addEventListener("change", () => (this.dirty = true));
    clock.onChange(() => (this.dirty = true));
    onSchemeChange(() => this.recolour());
    new ResizeObserver(() => this.resize()).observe(this.element);
    this.recolour();
    this.look("follow");
    const loop = (): void => {
      requestAnimationFrame(loop);
      if (this.dirty) this.draw();
      else if (!this.card && !this.fine && !this.clock.playing && performance.now() - this.drawn > STILL) this.refine();
    };
    loop();
  }

  private makeRenderer(): THREE.WebGLRenderer | null {
    try {
      const renderer = new THREE.WebGLRenderer({ antialias: this.card });
      renderer.setPixelRatio(this.sharpness.ratio);
      renderer.shadowMap.enabled = true;
      renderer.shadowMap.type = THREE.PCFShadowMap;
      renderer.domElement.setAttribute("role", "img");
      renderer.domElement.setAttribute(
        "aria-label",
        "Replay of the run in 3-D: robot, mechanism, wall. Drag to turn, wheel to come closer.",
      );
      this.element.append(renderer.domElement);
      return renderer;
    } catch {
      return null;
    }
  }

  private light(): void {
    this.scene.add(new THREE.HemisphereLight("#ffffff", "#b5b0aa", 2.1));
    const { sun } = this;
    sun.position.set(-2.5, -4, 6);
    this.sun.castShadow = this.card;
    sun.shadow.mapSize.set(1024, 1024);
    sun.shadow.bias = -0.0005;
    sun.shadow.normalBias = 0.02;
    Object.assign(sun.shadow.camera, { left: -3, right: 3, top: 3, bottom: -3, near: 0.5, far: 16 });
    this.scene.add(sun, sun.target);
    const m = this.actors[0]?.run.json.scene?.mechanism;
    if (m !== undefined) {
      // From the robot's side of the leaf, so that what it does stands in the light.
      const out = new THREE.Vector3(...m.normal);
      sun.target.position.set(m.handle[0] + 0.6 * out.x, m.handle[1] + 0.6 * out.y, 0.5);
      sun.position.copy(sun.target.position).add(new THREE.Vector3(3.5 * out.x - 2 * out.y, 3.5 * out.y + 2 * out.x, 6));
    }
    this.floor.receiveShadow = true;
    const lamp = new THREE.DirectionalLight("#ffffff", 0.6); // from the reader, so that no face is black
    this.camera.add(lamp);
    this.scene.add(this.floor, this.grid, this.camera);
  }

  private addPresets(): void {
    const bar = el("div", { class: "presets", role: "group", "aria-label": "Camera" });
    for (const preset of ["follow", "top", "side"] as const) {
      const b = button(preset, () => this.look(preset), { "aria-label": `Camera: ${preset}` });
      this.presets.set(preset, b);
      bar.append(b);
    }
    this.element.append(bar);
  }

  private recolour(): void {
    this.scene.background = new THREE.Color(colour("--sky"));
    this.floor.material.color.set(colour("--floor"));
    this.floor.position.z = -0.01;
    this.scene.remove(this.grid);
    this.grid = new THREE.GridHelper(16, 32, colour("--grid"), colour("--grid"));
    this.grid.rotation.x = Math.PI / 2;
    this.scene.add(this.grid);
    for (const actor of this.actors) actor.repaintMarks();
    this.dirty = true;
  }

  private mark(preset: Preset): void {
    this.preset = preset;
    for (const [name, b] of this.presets) b.setAttribute("aria-pressed", String(name === preset));
  }

  /** Middle between base and handle, the place where things happen. */
  private focus(): THREE.Vector3 {
    const { run } = this.actors[0];
    const time = this.local(run, this.clock.time);
    const hand = new THREE.Vector3(...run.vector("hand", time));
    const base = new THREE.Vector3(run.between("base_x", time), run.between("base_y", time), 0.7);
    if (!Number.isFinite(base.x)) return new THREE.Vector3(0, 0, 0.7);
    return Number.isFinite(hand.x) ? base.lerp(hand, 0.5) : base;
  }

  private directions(): { out: THREE.Vector3; side: THREE.Vector3 } {
    const m = this.actors[0].run.json.scene?.mechanism;
    const out = m === undefined ? new THREE.Vector3(-1, 0, 0) : new THREE.Vector3(m.normal[0], m.normal[1], 0);
    if (out.length() < 0.1) out.set(-1, 0, 0);
    out.normalize();
    // A hinge is best seen from the side on which the leaf does not stand in the way.
    const side = new THREE.Vector3(-out.y, out.x, 0);
    if (m?.type === "hinge" && new THREE.Vector3(...m.point).sub(new THREE.Vector3(...m.handle)).dot(side) > 0)
      side.negate();
    return { out, side };
  }

  look(preset: Preset): void {
    this.mark(preset);
    const at = this.focus();
    const { out, side } = this.directions();
    const wide = Math.max(1, 1.15 / this.camera.aspect);
    const eye = at.clone();
    if (preset === "top") eye.addScaledVector(out, 0.01).setZ(5.2 * wide);
    else if (preset === "side") eye.addScaledVector(side, 4.2 * wide).setZ(1.1);
    else
      eye
        .addScaledVector(out, 2.3 * wide)
        .addScaledVector(side, 2.4 * wide)
        .setZ(0.9 + 1.2 * wide);
    // From straight above, "up" in the picture is towards the wall.
    this.camera.up.set(0, 0, 1);
    this.camera.position.copy(eye);
    for (const actor of this.actors) actor.mechanism?.hideAbove(preset === "top" ? 1.8 : 99);
    this.controls?.target.copy(at);
    this.controls?.update();
    this.dirty = true;
  }

  private follow(): void {
    if (this.preset === "free" || this.controls === null) return;
    const shift = this.focus().sub(this.controls.target);
    if (this.preset === "side") shift.z = 0;
    this.camera.position.add(shift);
    this.controls.target.add(shift);
    this.camera.lookAt(this.controls.target);
  }

  private resize(): void {
    const { clientWidth: w, clientHeight: h } = this.element;
    if (w === 0 || h === 0 || this.renderer === null) return;
    this.renderer.setSize(w, h);
    this.camera.aspect = w / h;
    this.camera.updateProjectionMatrix();
    if (this.preset !== "free") this.look(this.preset);
    this.dirty = true;
  }

  /** Draws the same picture once more, as fine as a graphics card would. */
  private refine(): void {
    this.fine = true;
    this.sun.castShadow = true;
    this.renderer?.setPixelRatio(2 * Math.min(2, window.devicePixelRatio));
    this.renderer?.render(this.scene, this.camera);
  }

  private draw(): void {
    this.dirty = false;
    this.drawn = performance.now();
    const changed = this.sharpness.next(this.clock.playing, this.drawn);
    if (changed || this.fine) this.renderer?.setPixelRatio(this.sharpness.ratio);
    this.fine = false;
    this.sun.castShadow = this.card;
    for (const actor of this.actors) actor.show(this.local(actor.run, this.clock.time));
    this.follow();
    this.renderer?.render(this.scene, this.camera);
    this.element.dataset.frames = String(++this.frames);
  }
}
