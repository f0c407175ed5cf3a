/** The goals: a spot each, a ring as large as the robot's belief in it, and the ball that help holds the arm in. */

import { THREE } from "../three/index.js";
import { colour } from "./colours.js";

/** @import {Goal} from "./scene_description.js" */

export class GoalMarkers {
  /** @param {Goal[]} goals */
  constructor(goals) {
    this._goals = goals;
    this._spots = goals.map((goal) => {
      const spot = new THREE.Mesh(new THREE.SphereGeometry(0.016, 16, 12), new THREE.MeshLambertMaterial());
      spot.position.set(...goal.position);
      return spot;
    });
    this._rings = goals.map((goal) => {
      const ring = new THREE.Mesh(new THREE.TorusGeometry(1, 0.07, 5, 36), new THREE.MeshBasicMaterial({ transparent: true }));
      ring.position.set(...goal.position);
      // Faces whichever view is being drawn.
      ring.onBeforeRender = (_renderer, _scene, camera) => {
        ring.quaternion.copy(camera.quaternion);
        ring.updateMatrixWorld(true);
      };
      return ring;
    });
    this._ball = new THREE.Mesh(
      new THREE.SphereGeometry(1, 24, 16),
      new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.18, depthWrite: false, side: THREE.DoubleSide }),
    );
    this._ball.visible = false;
    this.objects = [...this._spots, ...this._rings, this._ball];
  }

  /** How sure the robot is of each goal: the size of its ring. @param {number[] | null} belief */
  believe(belief) {
    this._rings.forEach((ring, index) => {
      const share = belief?.[index] ?? 0;
      ring.visible = belief !== null;
      ring.scale.setScalar(0.03 + 0.06 * share);
      ring.material.opacity = 0.45 + 0.55 * share;
    });
  }

  /** The ball around the likeliest goal that help may hold the arm in. @param {number | null} radius m @param {number} goal */
  bound(radius, goal) {
    this._ball.visible = radius !== null && radius > 0 && goal >= 0;
    if (!this._ball.visible || radius === null) return;
    this._ball.position.set(...this._goals[goal].position);
    this._ball.scale.setScalar(radius);
  }

  repaint() {
    this._ball.material.color.set(colour("ring"));
    for (const ring of this._rings) ring.material.color.set(colour("ring"));
    for (const spot of this._spots) spot.material.color.set(colour("food"));
  }
}
