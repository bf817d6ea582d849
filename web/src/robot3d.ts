/** Robot and mechanism as three.js objects that take a posture. */
import * as THREE from "three";
import type { BoxJson, DrawingJson, MechanismJson, PoseJson, SceneJson, ShapeJson } from "./run";

/** How the bodies of one run are painted: as they are, or as a tinted ghost. */
export interface Paint {
  tint?: string;
  opacity: number;
}

function place(object: THREE.Object3D, pose: PoseJson): void {
  object.position.set(...pose.position);
  object.quaternion.set(pose.turn.x, pose.turn.y, pose.turn.z, pose.turn.w);
}

function material(rgb: THREE.ColorRepresentation, paint: Paint): THREE.MeshLambertMaterial {
  const color = new THREE.Color(rgb);
  if (paint.tint !== undefined) color.lerp(new THREE.Color(paint.tint), 0.65);
  return new THREE.MeshLambertMaterial({ color, transparent: paint.opacity < 1, opacity: paint.opacity });
}

/** three.js has its cylinders along y, a URDF along z. */
function geometry(shape: ShapeJson): THREE.BufferGeometry {
  const [a, b, c] = shape.size;
  switch (shape.kind) {
    case "box":
      return new THREE.BoxGeometry(a, b, c);
    case "sphere":
      return new THREE.SphereGeometry(a, 20, 14);
    case "cylinder":
      return new THREE.CylinderGeometry(a, a, c, 28).rotateX(Math.PI / 2);
    case "capsule":
      return new THREE.CapsuleGeometry(a, c, 6, 20).rotateX(Math.PI / 2);
  }
}

/** A bar between two points of one frame: stands for a part that the robot's file gives no shape. */
function bar(to: THREE.Vector3, radius: number, paint: Paint): THREE.Mesh {
  const mesh = new THREE.Mesh(new THREE.CapsuleGeometry(radius, to.length(), 4, 12), material("#8a929c", paint));
  mesh.position.copy(to).multiplyScalar(0.5);
  mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), to.clone().normalize());
  return mesh;
}

export class RobotFigure {
  readonly root = new THREE.Group();
  private readonly joints: {
    group: THREE.Group;
    rest: THREE.Quaternion;
    origin: THREE.Vector3;
    axis: THREE.Vector3;
    slides: boolean;
  }[] = [];

  constructor(scene: SceneJson | null, paint: Paint) {
    const drawing = scene?.robot?.drawing;
    if (drawing !== undefined) this.build(drawing, paint);
    if (drawing === undefined || drawing.shapes.every((s) => s.joint >= 0)) this.addFootprint(scene, paint);
    this.root.traverse((o) => {
      o.castShadow = paint.opacity === 1;
      o.receiveShadow = false;
    });
  }

  private build(drawing: DrawingJson, paint: Paint): void {
    let parent = this.root;
    for (const joint of drawing.joints) {
      const group = new THREE.Group();
      place(group, joint.pose);
      parent.add(group);
      this.joints.push({
        group,
        rest: group.quaternion.clone(),
        origin: group.position.clone(),
        axis: new THREE.Vector3(...joint.axis),
        slides: joint.slides,
      });
      parent = group;
    }
    for (const shape of drawing.shapes) {
      const [r, g, b] = shape.rgba;
      const mesh = new THREE.Mesh(geometry(shape), material(new THREE.Color().setRGB(r, g, b, THREE.SRGBColorSpace), paint));
      place(mesh, shape.pose);
      (shape.joint < 0 ? this.root : this.joints[shape.joint].group).add(mesh);
    }
    this.joints.forEach((joint, i) => {
      if (drawing.shapes.some((s) => s.joint === i)) return;
      const next = i + 1 < this.joints.length ? this.joints[i + 1].origin : new THREE.Vector3(...drawing.hand.position);
      if (next.length() > 0.02) joint.group.add(bar(next, 0.03, paint));
    });
  }

  private addFootprint(scene: SceneJson | null, paint: Paint): void {
    const [x0, x1, y0, y1] = scene?.robot?.footprint_m ?? [-0.3, 0.3, -0.25, 0.25];
    const body = new THREE.Mesh(new THREE.BoxGeometry(x1 - x0, y1 - y0, 0.3), material("#c9ced6", paint));
    body.position.set((x0 + x1) / 2, (y0 + y1) / 2, 0.18);
    this.root.add(body);
  }

  /** Values that are not numbers leave the part where it was. */
  pose(x: number, y: number, yaw: number, q: number[]): void {
    if (Number.isFinite(x + y + yaw)) {
      this.root.position.set(x, y, 0);
      this.root.rotation.set(0, 0, yaw);
    }
    const turn = new THREE.Quaternion();
    this.joints.forEach((joint, i) => {
      if (!Number.isFinite(q[i])) return;
      if (joint.slides)
        joint.group.position.copy(joint.axis).multiplyScalar(q[i]).applyQuaternion(joint.rest).add(joint.origin);
      else joint.group.quaternion.copy(joint.rest).multiply(turn.setFromAxisAngle(joint.axis, q[i]));
    });
  }
}

function boxMesh(box: BoxJson, of: THREE.Material): THREE.Mesh {
  const [a, b, c] = box.half_extents;
  const mesh = new THREE.Mesh(new THREE.BoxGeometry(2 * a, 2 * b, 2 * c), of);
  const basis = new THREE.Matrix4().makeBasis(
    ...(box.axes.map((v) => new THREE.Vector3(...v)) as [THREE.Vector3, THREE.Vector3, THREE.Vector3]),
  );
  mesh.quaternion.setFromRotationMatrix(basis);
  mesh.position.set(...box.centre);
  return mesh;
}

export class MechanismFigure {
  readonly root = new THREE.Group();
  readonly world = new THREE.Group();
  private readonly leaf = new THREE.Group();

  constructor(
    private readonly mechanism: MechanismJson,
    paint: Paint,
    withWorld: boolean,
  ) {
    const wood = material("#c29a66", paint);
    for (const box of mechanism.leaf) this.leaf.add(boxMesh(box, wood));
    this.addHandle(paint);
    this.root.add(this.leaf);
    const wall = new THREE.MeshLambertMaterial({ color: "#b9bfc8" });
    if (withWorld) for (const box of mechanism.world) this.world.add(boxMesh(box, wall));
    this.root.add(this.world);
    this.leaf.traverse((o) => (o.castShadow = paint.opacity === 1));
    this.root.traverse((o) => (o.receiveShadow = true));
  }

  private addHandle(paint: Paint): void {
    const m = this.mechanism;
    const metal = material("#3d434b", paint);
    const centre = new THREE.Vector3(...m.handle);
    const radius = Math.max(0.006, (m.handle_thickness ?? 0.02) / 2);
    const along = new THREE.Vector3(...(m.handle_bar ?? [0, 0, 1])).normalize();
    const length = m.handle_kind === "knob" ? 2 * radius : Math.max(0.05, m.handle_length ?? 0.12);
    const grip = new THREE.Mesh(new THREE.CapsuleGeometry(radius, length, 4, 14), metal);
    grip.position.copy(centre);
    grip.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along);
    this.leaf.add(grip);
    const inward = new THREE.Vector3(...m.normal).multiplyScalar(-(m.handle_standoff ?? 0.06));
    if (m.handle_kind === "recess" || m.handle_kind === "none") return;
    for (const side of m.handle_kind === "knob" ? [0] : [-0.5, 0.5]) {
      const post = new THREE.Mesh(new THREE.CylinderGeometry(radius * 0.7, radius * 0.7, inward.length(), 12), metal);
      post.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), inward.clone().normalize());
      post.position
        .copy(centre)
        .addScaledVector(along, side * length)
        .addScaledVector(inward, 0.5);
      this.leaf.add(post);
    }
  }

  open(q: number): void {
    if (!Number.isFinite(q)) return;
    const m = this.mechanism;
    const axis = new THREE.Vector3(...m.axis);
    if (m.type === "slide") {
      this.leaf.position.copy(axis).multiplyScalar(q);
      return;
    }
    const point = new THREE.Vector3(...m.point);
    this.leaf.quaternion.setFromAxisAngle(axis, q);
    this.leaf.position.copy(point).sub(point.clone().applyQuaternion(this.leaf.quaternion));
  }

  /** From above, what hangs higher than a hand reaches would hide everything. */
  hideAbove(height: number): void {
    for (const mesh of this.world.children) {
      const box = new THREE.Box3().setFromObject(mesh);
      mesh.visible = box.min.z < height;
    }
  }
}
