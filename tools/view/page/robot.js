// The robot in three dimensions, from its URDF, moved by joint_state.
//
// Joints of joint_state: in order those that the URDF drives, or all that move, whichever has their number. The base is
// where sim_body_truth says; without it, where the URDF has it.

import { AmbientLight, Box3, Color, DirectionalLight, GridHelper, Group, MeshStandardMaterial, OrbitControls, PerspectiveCamera, Scene,
  URDFLoader, Vector3, WebGLRenderer } from './vendor/robot_libs.js';

const MOST_FRAMES_PER_S = 15;
const PALE = 0xb9c4d0;

export class RobotView {
  // Throws Error: no WebGL, or no URDF that can be read.
  constructor(element, urdf, names) {
    this.element = element;
    this.names = names;
    this.drawn_ms = -Infinity;
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
    loader.packages = () => '/robot';
    this.robot = loader.parse(urdf);
    this.robot.traverse((part) => {
      if (!part.isMesh) return;
      const colour = part.material?.color;
      const plain = !colour || colour.getHex() === 0xffffff;
      // The loader takes the numbers of the URDF as linear; they are meant as sRGB.
      const meant = plain ? new Color(PALE) : new Color().setRGB(colour.r, colour.g, colour.b, 'srgb');
      part.material = new MeshStandardMaterial({ color: meant, roughness: 0.65, metalness: 0.1 });
    });
    this.base = new Group();
    this.base.add(this.robot);
    this.scene.add(this.base);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => { this.moved = true; });
    this.frame();
    new ResizeObserver(() => { this.moved = true; this.resize(); }).observe(element);
    this.resize();
  }

  // The whole robot in the picture, and a grid under it.
  frame() {
    const box = new Box3().setFromObject(this.robot);
    const centre = box.getCenter(new Vector3());
    const size = Math.max(box.getSize(new Vector3()).length(), 0.2);
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).add(new Vector3(1.1, -1.3, 0.5).multiplyScalar(size));
    this.controls.update();
    if (this.grid) this.scene.remove(this.grid);
    this.grid = new GridHelper(4 * size, 16, 0x8899aa, 0x8899aa);
    this.grid.material.transparent = true;
    this.grid.material.opacity = 0.3;
    this.grid.rotation.x = Math.PI / 2;
    this.grid.position.set(centre.x, centre.y, box.min.z);
    this.scene.add(this.grid);
    this.moved = true;
  }

  resize() {
    const width = Math.max(this.element.clientWidth, 50);
    const height = Math.max(this.element.clientHeight, 50);
    this.renderer.setPixelRatio(devicePixelRatio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  // joint_state and sim_body_truth as objects, or undefined.
  pose(joints, body) {
    if (joints) {
      const names = this.names.driven.length === joints.joint_count ? this.names.driven
        : this.names.moving.length === joints.joint_count ? this.names.moving : [];
      this.fits = names.length > 0;
      names.forEach((name, i) => this.robot.setJointValue(name, joints.position_rad[i]));
    }
    if (body) {
      const [w, x, y, z] = body.orientation_wxyz;
      this.base.position.fromArray(body.position_m);
      this.base.quaternion.set(x, y, z, w);
      if (!this.placed) {  // the camera follows once: then the person at the page decides
        this.placed = true;
        this.base.updateMatrixWorld(true);
        this.frame();
      }
    }
    this.moved = true;
  }

  due(now_ms) { return now_ms - this.drawn_ms >= 1000 / MOST_FRAMES_PER_S; }

  draw(now_ms) {
    if (!this.moved) return;
    const begin = performance.now();
    this.moved = false;
    this.drawn_ms = now_ms;
    this.renderer.render(this.scene, this.camera);
    this.task_ms += performance.now() - begin;
    ++this.frames;
  }
}
