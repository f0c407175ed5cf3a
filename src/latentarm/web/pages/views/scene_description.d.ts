/** What `/scene.json` holds; see `latentarm.web.protocol.scene`. Lengths in m, quaternions w, x, y, z. */

export type Vector = [number, number, number];
export type Quaternion = [number, number, number, number];

export interface Geom {
  type: "sphere" | "capsule" | "ellipsoid" | "cylinder" | "box" | "mesh";
  /** MuJoCo's: half lengths and radii. */
  size: Vector;
  pos: Vector;
  quat: Quaternion;
  rgba: [number, number, number, number];
  mesh: number | null;
}

export interface Plane {
  name: string;
  type: "plane";
  point: Vector;
  normal: Vector;
}

export type Solid =
  | { name: string; type: "sphere"; centre: Vector; radius: number }
  | { name: string; type: "capsule"; start: Vector; end: Vector; radius: number }
  | { name: string; type: "box"; pos: Vector; quat: Quaternion; half_extents: Vector };

export type Obstacle = Plane | Solid;

/** Where no part of the arm is faster than the speed, m/s. */
export type Zone = Obstacle & { speed: number };

export interface Goal {
  name: string;
  position: Vector;
}

/** One finger of a gripper, closed; it slides along `opens` on the body of that number. */
export interface Finger {
  body: number;
  opens: Vector;
  /** How far it is open at first. */
  at: number;
  geoms: Geom[];
}

export interface Thing {
  name: string;
  /** At first: x, y, z and a quaternion. */
  pose: [number, number, number, number, number, number, number];
  /** Whether it stands where it is. */
  fixed: boolean;
  geoms: Geom[];
  /** What gives way to everything; scenes of earlier versions have none. */
  soft?: Geom[];
}

/** Equal round grains. */
export interface Grains {
  name: string;
  radius: number;
  rgba: [number, number, number, number];
  /** At first: x, y, z of one after the other. */
  positions: number[];
}

export interface SceneDescription {
  bodies: { name: string; geoms: Geom[] }[];
  fingers: Finger[];
  things: Thing[];
  grains: Grains[];
  goals: Goal[];
  obstacles: Obstacle[];
  /** Scenes of earlier versions have none. */
  zones?: Zone[];
}
