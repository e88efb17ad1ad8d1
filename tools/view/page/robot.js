// The robot in three dimensions, from its URDF, moved by joint_state.
//
// Joints of joint_state: in order those that the URDF drives, or all that move, whichever has their number. The base is
// where sim_body_truth says; without it, where the URDF has it.

import { AmbientLight, Box3, Color, DirectionalLight, GridHelper, Group, MeshStandardMaterial, OrbitControls, PerspectiveCamera, Scene,
  URDFLoader, Vector3, WebGLRenderer } from './vendor/robot_libs.js';
import { watchVisibility } from './frames.js';

const PALE = 0xb9c4d0;
const VIEW_FROM = new Vector3(0.9, -1.06, 0.41);  // in sizes of the box: the sphere around it fills the height of the picture
const AROUND = 0.1;  // of its size: so far it may move before the camera does
const UNSEEN = 1e-3;  // rad, m: what the picture of a robot of 1 m moves by less than a fifth of a pixel

export class RobotView {
  // want(): it is to be drawn. Throws Error: no WebGL, or no URDF that can be read.
  constructor(element, urdf, names, want) {
    this.element = element;
    this.names = names;
    this.want = want;
    this.visible = true;
    this.posed = [];  // joints, and the base, as they were drawn
    this.task_ms = 0;
    this.frames = 0;
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true });
    element.append(this.renderer.domElement);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(40, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.scene.add(new AmbientLight(0xffffff, 1.3));
    const light = new DirectionalLight(0xffffff, 2.2);
    light.position.set(2, -3, 4);
    this.scene.add(light);
    const loader = new URDFLoader();
    loader.workingPath = '/robot/';
    loader.packages = (name) => `/robot/${name}`;
    loader.manager.onLoad = () => {  // of the meshes, which come later
      this.paint();
      this.follow();
      this.move();
    };
    this.robot = loader.parse(urdf);
    this.paint();
    this.base = new Group();
    this.base.add(this.robot);
    this.scene.add(this.base);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => this.move());
    this.controls.addEventListener('start', () => { this.steered = true; });
    this.begin();
    new ResizeObserver(() => this.resize()).observe(element);
    this.resize();
    watchVisibility(element, (visible) => {
      this.visible = visible;
      if (visible) want();
    });
  }

  // Gives what has no material of this page one.
  paint() {
    this.robot.traverse((part) => {
      if (!part.isMesh || part.material instanceof MeshStandardMaterial) return;
      const colour = part.material?.color;
      const plain = !colour || colour.getHex() === 0xffffff;
      // The loader takes the numbers of the URDF as linear; they are meant as sRGB.
      const meant = plain ? new Color(PALE) : new Color().setRGB(colour.r, colour.g, colour.b, 'srgb');
      part.material = new MeshStandardMaterial({ color: meant, roughness: 0.65, metalness: 0.1 });
    });
  }

  // Where the robot has been stays in the picture, until the person at the page moves the camera.
  follow() {
    if (this.steered) return;
    const box = new Box3().setFromObject(this.robot);
    if (this.seen.containsBox(box)) return;
    this.floor_m = Math.min(this.floor_m, box.min.z);
    this.frame(box.expandByScalar(AROUND * box.getSize(new Vector3()).length()).union(this.seen));
  }

  // The robot as it stands in the picture.
  begin() {
    const box = new Box3().setFromObject(this.robot);
    this.floor_m = box.min.z;
    this.frame(box);
  }

  // That box in the picture, and a grid under it.
  frame(box) {
    this.seen = box.clone();
    const centre = box.getCenter(new Vector3());
    const size = Math.max(box.getSize(new Vector3()).length(), 0.2);
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(VIEW_FROM, size);
    this.controls.update();
    if (this.grid) {
      this.scene.remove(this.grid);
      this.grid.dispose();
    }
    this.grid = new GridHelper(4 * size, 16, 0x8899aa, 0x8899aa);
    this.grid.material.transparent = true;
    this.grid.material.opacity = 0.3;
    this.grid.rotation.x = Math.PI / 2;
    this.grid.position.set(centre.x, centre.y, this.floor_m);
    this.scene.add(this.grid);
    this.move();
  }

  // As the page began: the camera follows the robot again.
  resetCamera() {
    this.steered = false;
    this.begin();
  }

  // Something else than the robot has changed.
  move() {
    this.moved = true;
    this.want();
  }

  resize() {
    const width = Math.max(this.element.clientWidth, 50);
    const height = Math.max(this.element.clientHeight, 50);
    this.renderer.setPixelRatio(devicePixelRatio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.move();
  }

  // joint_state and sim_body_truth as objects, or undefined. Moves the robot when that is seen.
  pose(joints, body) {
    const names = !joints ? [] : this.names.driven.length === joints.joint_count ? this.names.driven
      : this.names.moving.length === joints.joint_count ? this.names.moving : [];
    const pose = names.map((_, i) => joints.position_rad[i]);
    if (body) pose.push(...body.position_m, ...body.orientation_wxyz);
    if (pose.length === this.posed.length && pose.every((value, i) => Math.abs(value - this.posed[i]) < UNSEEN)) return;
    this.posed = pose;
    this.moved = true;
    names.forEach((name, i) => this.robot.setJointValue(name, joints.position_rad[i]));
    if (!body) {
      this.follow();
      return;
    }
    const [w, x, y, z] = body.orientation_wxyz;
    this.base.position.fromArray(body.position_m);
    this.base.quaternion.set(x, y, z, w);
    this.base.updateMatrixWorld(true);
    if (this.placed) {
      this.follow();
    } else {  // not where the URDF had it
      this.placed = true;
      if (!this.steered) this.begin();
    }
  }

  // True: it was drawn.
  draw() {
    if (!this.moved || !this.visible) return false;
    const begin = performance.now();
    this.moved = false;
    this.renderer.render(this.scene, this.camera);
    this.task_ms += performance.now() - begin;
    ++this.frames;
    return true;
  }
}
