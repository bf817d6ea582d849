/** What is drawn over the replay: paths, axis and its doubt, forces. */
import * as THREE from "three";
import { colour } from "./dom";
import type { Run } from "./run";

/** Length of a force arrow [m/N]: 20 N are as long as a hand. */
const METRES_PER_NEWTON = 0.01;
/** Half length of a drawn axis [m]. */
const AXIS = 1.1;
/** Cones wider than this say "anything" and would hide the scene [rad]. */
const WIDEST = 0.9;

const UP = new THREE.Vector3(0, 1, 0);

function arrow(color: string): THREE.ArrowHelper {
  const helper = new THREE.ArrowHelper(new THREE.Vector3(1, 0, 0), new THREE.Vector3(), 0.1, color);
  helper.traverse((o) => {
    if (o instanceof THREE.Mesh || o instanceof THREE.Line) (o.material as THREE.Material).depthTest = false;
    o.renderOrder = 3;
  });
  return helper;
}

function point(helper: THREE.ArrowHelper, from: THREE.Vector3, vector: THREE.Vector3): void {
  const length = vector.length();
  helper.visible = length > 0.012 && Number.isFinite(length);
  if (!helper.visible) return;
  helper.position.copy(from);
  helper.setDirection(vector.clone().divideScalar(length));
  helper.setLength(length, Math.min(0.07, 0.4 * length), Math.min(0.035, 0.2 * length));
}

function line(points: THREE.Vector3[], color: string, dashed = false): THREE.Line {
  const of = dashed
    ? new THREE.LineDashedMaterial({ color, dashSize: 0.05, gapSize: 0.04 })
    : new THREE.LineBasicMaterial({ color });
  const made = new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), of);
  if (dashed) made.computeLineDistances();
  return made;
}

/** A cone with its tip at the origin along +y, height and radius 1. */
function cone(color: string): THREE.Mesh {
  const shape = new THREE.ConeGeometry(1, 1, 40, 1, true).rotateX(Math.PI).translate(0, 0.5, 0);
  return new THREE.Mesh(
    shape,
    new THREE.MeshBasicMaterial({ color, transparent: true, opacity: 0.22, side: THREE.DoubleSide, depthWrite: false }),
  );
}

function aim(mesh: THREE.Mesh, tip: THREE.Vector3, direction: THREE.Vector3, height: number, halfAngle: number): void {
  const angle = Math.min(WIDEST, halfAngle);
  mesh.visible = Number.isFinite(angle);
  if (!mesh.visible) return;
  mesh.position.copy(tip);
  mesh.quaternion.setFromUnitVectors(UP, direction);
  mesh.scale.set(height * Math.tan(angle), height, height * Math.tan(angle));
}

/** The path of the hand up to now. */
class Trace {
  readonly line: THREE.Line;
  private rows = 0;

  constructor(
    private readonly run: Run,
    color: string,
  ) {
    this.line = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color }));
    this.line.frustumCulled = false;
  }

  show(time: number): void {
    if (this.rows !== this.run.rows) this.refill();
    this.line.geometry.setDrawRange(0, this.run.row(time) + 1);
  }

  private refill(): void {
    this.rows = this.run.rows;
    const points = new Float32Array(3 * this.rows);
    const last = [0, 0, 0];
    for (let i = 0; i < this.rows; ++i) {
      ["hand_x", "hand_y", "hand_z"].forEach((name, k) => {
        const v = this.run.at(name, i);
        if (Number.isFinite(v)) last[k] = v;
        points[3 * i + k] = last[k];
      });
    }
    this.line.geometry.dispose();
    this.line.geometry = new THREE.BufferGeometry();
    this.line.geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
  }
}

export class Marks {
  readonly root = new THREE.Group();
  private readonly trace: Trace;
  private readonly pull = arrow(colour("--c2"));
  private readonly normal = arrow(colour("--bad"));
  private readonly believedAxis = line([new THREE.Vector3(0, -AXIS, 0), new THREE.Vector3(0, AXIS, 0)], colour("--c3"));
  private readonly cones = [cone(colour("--c3")), cone(colour("--c3"))];
  private readonly directionCone = cone(colour("--c1"));
  private readonly direction = arrow(colour("--c1"));

  /** @param tint  Colour of the path where several runs are compared; nothing else is drawn over them then */
  constructor(
    private readonly run: Run,
    private readonly tint?: string,
  ) {
    this.trace = new Trace(run, tint ?? colour("--c1"));
    this.root.add(this.trace.line);
    if (tint !== undefined) return;
    this.root.add(this.pull, this.normal, this.believedAxis, ...this.cones, this.directionCone, this.direction);
    const m = run.json.scene?.mechanism;
    if (m?.type === "hinge") {
      const point = new THREE.Vector3(...m.point);
      point.addScaledVector(
        new THREE.Vector3(...m.axis),
        new THREE.Vector3(...m.handle).sub(point).dot(new THREE.Vector3(...m.axis)),
      );
      const along = new THREE.Vector3(...m.axis).multiplyScalar(AXIS);
      this.root.add(line([point.clone().sub(along), point.clone().add(along)], colour("--truth"), true));
    }
  }

  show(time: number): void {
    this.trace.show(time);
    if (this.tint !== undefined) return;
    const hand = new THREE.Vector3(...this.run.vector("hand", time));
    this.showForces(hand, time);
    this.showBelief(hand, time);
  }

  private showForces(hand: THREE.Vector3, time: number): void {
    const force = new THREE.Vector3(...this.run.vector("force", time));
    const along = new THREE.Vector3(...this.run.vector("est_dir", time));
    const share = Number.isFinite(along.x) ? along.clone().multiplyScalar(force.dot(along)) : new THREE.Vector3();
    point(this.pull, hand, share.clone().multiplyScalar(METRES_PER_NEWTON));
    point(this.normal, hand, force.sub(share).multiplyScalar(METRES_PER_NEWTON));
  }

  private showBelief(hand: THREE.Vector3, time: number): void {
    const direction = new THREE.Vector3(...this.run.vector("est_dir", time));
    const known = Number.isFinite(direction.x) && direction.length() > 0.5;
    this.direction.visible = this.directionCone.visible = known;
    if (known) {
      direction.normalize();
      point(this.direction, hand, direction.clone().multiplyScalar(0.3));
      aim(this.directionCone, hand, direction, 0.3, (this.run.between("direction_2sigma", time) * Math.PI) / 180);
    }
    const k = new THREE.Vector3(...this.run.vector("est_curv", time));
    const size = k.length();
    const doubt = this.run.between("curvature_2sigma", time) / size;
    // An axis further away than 3 m, or one of which nothing is known, is no axis to show.
    const axis = known && size > 0.33 && doubt < 1;
    this.believedAxis.visible = axis;
    for (const mesh of this.cones) mesh.visible = axis;
    if (!axis) return;
    const centre = hand.clone().addScaledVector(k.clone().cross(direction), 1 / (size * size));
    const unit = k.clone().divideScalar(size);
    this.believedAxis.position.copy(centre);
    this.believedAxis.quaternion.setFromUnitVectors(UP, unit);
    const half = Math.atan(doubt);
    aim(this.cones[0], centre, unit, AXIS, half);
    aim(this.cones[1], centre, unit.clone().negate(), AXIS, half);
  }
}
