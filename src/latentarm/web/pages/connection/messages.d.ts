// Written by `make message-types` from the messages that the server declares.

export interface AnswerQuestion {
  type: "answer";
  question: number;
  u: number[];
}

export interface BeginPersonalise {
  type: "personalise";
  name: string;
  questions: number;
  seat?: "facing" | "behind" | null;
}

export interface BeginTask {
  type: "begin_run";
  choice?: number | null;
  anew: boolean;
}

export interface ChooseHelp {
  type: "help";
  level: "off" | "low" | "medium" | "high";
}

export interface ChooseMode {
  type: "mode";
  mode: "latent" | "assisted" | "end_effector";
  axes?: number | null;
}

export interface ChooseProfile {
  type: "profile";
  name: string | null;
  seat?: "facing" | "behind" | null;
}

export interface ChosenEpisode {
  file: string;
  episode: number;
}

export interface ConfirmChecklist {
  type: "confirm";
  arm_start: number;
  stop: true;
  area: true;
  payload: true;
}

export interface CopilotPace {
  type: "copilot_pace";
  pace: number;
  nonce: string;
}

export interface CopilotState {
  id: string;
  name: string | number;
  pace: number;
}

export interface DriveRecord {
  version: 1;
  id: string;
  person: string | null;
  title: string;
  started: string;
  time_s: number;
  moving_s: number;
  robot: string;
  real: boolean;
  task: string;
  choice: string | null;
  run: string | null;
  profile: string | null;
  modes: ("latent" | "assisted" | "end_effector")[];
  inputs: string[];
  input_s: Record<string, number> | null;
  presses: number;
  stops: number;
  late_stops: number;
  reasons: Record<string, number>;
  way_m: number;
  help: number | null;
  help_level: string | null;
  steps_done: number | null;
  steps: number | null;
  outcome: "success" | "failure" | null;
  why: string | null;
  ended: "reset" | "again" | "next" | "driver_changed" | "run_changed" | "server_ended" | "broken_off";
  scene: string | null;
}

export interface DriverInput {
  seq: number;
  nonce: string;
  source: "pointer" | "keyboard" | "dpad" | "gamepad" | "switch";
  latched: boolean;
  device?: number;
  name?: string;
  raw?: [number, number] | null;
  opens?: boolean;
  type: "input";
  u: number[];
  gripper?: "open" | "close" | "toggle" | null;
}

export interface EditPoses {
  type: "save_pose" | "delete_pose";
  name: string;
}

export interface Fill {
  thing: string;
  share: number;
  enough: number | null;
}

export interface Ghosts {
  up: [number, number, number][];
  down: [number, number, number][];
  left: [number, number, number][];
  right: [number, number, number][];
  ring: [number, number, number, number, number, number, number][];
}

export interface GoToPose {
  type: "to_pose";
  name: string;
  built_in?: "home" | "tuck" | null;
}

export interface GripperState {
  width_m: number;
  holding: boolean;
  closing: boolean | null;
}

export interface HandOver {
  type: "hand_over" | "accept_copilot";
  to: string;
}

export interface Hello {
  type: "hello";
  version: 1;
  name?: string | null;
  person?: string | null;
}

export interface KeepGuiding {
  type: "guided";
  gripper?: "open" | "close" | "toggle" | null;
}

export interface LearningState {
  type: "learning";
  training: Training | null;
  personalise: Personalise | null;
  recordings: Recorded[];
  runs: string[];
  run: string | null;
  profiles: string[];
}

export interface LeaveQuestion {
  type: "skip_question" | "question_before";
  question: number;
}

export interface Lesson {
  recordings: number;
  learned_from: number;
  short: number[];
  speeds_m_s: number[];
  weak: number[];
}

export interface Lost {
  thing: string;
  step: number;
}

export interface Mark {
  t: number;
  code: string;
}

export interface MotionWithoutStick {
  type: "guide" | "return";
  on: boolean;
}

export interface NamedPlace {
  name: string;
  position: [number, number, number];
}

export interface NamedZone {
  name: string;
  speed: number;
}

export interface Notice {
  code: "answers_agree" | "answers_alike" | "answers_few" | "answers_unclear" | "answers_weak" | "arm_emergency_stop" | "arm_fault" | "arm_off" | "clock_jumped" | "clock_stood_still" | "controller_failed" | "controller_invalid" | "emergency_stop_released" | "force_high" | "gripper_invalid" | "input_invalid" | "input_late" | "joint_astray" | "joint_frozen" | "joint_jumped" | "joints_invalid" | "let_go_first" | "loop_late" | "no_smooth_path" | "not_enabled" | "reading_invalid" | "reading_old" | "readings_unsteady" | "slide_astray" | "slide_jumped" | "arm_lost" | "arm_process_ended" | "arm_process_silent" | "arm_stopped" | "asking" | "asking_already" | "at_pose" | "at_start" | "cameras_full" | "cameras_gone" | "checklist_first" | "checking_run" | "copilot_began" | "copilot_changed" | "copilot_ended" | "copilot_gone" | "copilot_late" | "disk_full" | "disk_too_slow" | "drive_over" | "driver_changed" | "driver_expired" | "driver_gone" | "driver_released" | "episodes_too_short" | "error" | "expired" | "full" | "guiding_ended" | "guiding_page_gone" | "handed_over" | "idle" | "import_invalid" | "journal_full" | "journal_lost" | "journal_unwritable" | "joints_unreadable" | "latch_ended" | "loading_run" | "message_invalid" | "model_unknown" | "name_invalid" | "no_hello" | "no_run" | "not_loaded" | "page_refused" | "page_stopped" | "path_blocked" | "person_driving" | "person_name_invalid" | "person_name_taken" | "person_unknown" | "pin_needed" | "pin_wait" | "pin_wrong" | "pose_name_invalid" | "pose_pushed" | "pose_stuck" | "pose_unreachable" | "profile_exists" | "question_began" | "reconnected" | "reconnecting" | "record_unknown" | "record_unreadable" | "recording_cut" | "recording_ended" | "recording_in_use" | "recording_left_out" | "recording_still" | "recording_unreadable" | "recordings_of_rates" | "recordings_of_robots" | "recordings_of_tasks" | "request_invalid" | "return_blocked" | "return_not_now" | "return_pushed" | "return_stuck" | "run_exists" | "run_too_slow" | "setup_locked" | "shadow_stays" | "stop_first" | "stop_pressed" | "stop_pressed_by" | "thing_lost" | "thing_moved" | "thing_unseen" | "too_few_episodes" | "too_many_axes" | "too_many_people" | "too_many_poses" | "touch_refused" | "work_broke_off";
  parameters: Record<string, string | number>;
}

export interface Person {
  id: string;
  name: string | number;
}

export interface Personalise {
  phase: "preparing" | "asking" | "thinking" | "learning" | "learned" | "refused" | "kept" | "failed";
  name: string;
  question: number;
  number: number;
  of: number;
  back: boolean;
  motion: ShownMotion | null;
  share: number;
  answers: number;
  error: number | null;
  error_without: number | null;
  why: Notice | null;
}

export interface PickRun {
  type: "run";
  run: string;
}

export interface Poses {
  type: "poses";
  names: string[];
  problem: Notice | null;
}

export interface Press {
  type: "enable" | "ask_to_drive" | "release" | "trail_clear" | "cancel_training";
}

export interface PressCopilot {
  type: "ask_to_copilot" | "end_copilot";
}

export interface PressPersonalise {
  type: "cancel_personalise" | "try_alignment" | "keep_alignment" | "discard_alignment";
}

export interface PressStop {
  type: "stop";
  why?: "pressed" | "page";
}

export interface RealArm {
  facts: [string, string][];
  shadow: boolean;
}

export interface Reconnect {
  type: "reconnect";
}

export interface RecordEpisode {
  type: "record";
  on: boolean;
  task?: string;
  by_hand?: boolean;
}

export interface Recorded {
  number: number;
  file: string;
  episode: number;
  task: string;
  seconds: number;
  started: string;
  earlier: boolean;
}

export interface RecordedEpisode {
  number: number;
  task: string;
  seconds: number;
  person: string;
  started: string;
  complete: boolean;
}

export interface Recording {
  on: boolean;
  samples: number;
  episodes: number;
  problem: Notice | null;
}

export interface RecordingFile {
  name: string;
  title: string;
  bytes: number;
  episodes: RecordedEpisode[];
  in_use: boolean;
  problem: Notice | null;
}

export interface Refused {
  type: "refused";
  notice: Notice;
}

export interface Reset {
  type: "reset";
}

export interface SeenThing {
  name: string;
  seen: "unseen" | "seen" | "doubted" | "carried" | "lost";
  age_s: number;
  source: string;
}

export interface ShownMotion {
  duration_s: number;
  frames: number[][][];
  tools: [number, number, number][][];
}

export interface State {
  nonce: string;
  tick: number;
  phase: "disengaged" | "neutral_needed" | "ready" | "moving" | "stopping";
  note: Notice | null;
  reason: Notice | null;
  held_back: "clearance" | "freshness" | "workspace" | "joint_position" | "force" | "zone" | null;
  zone: string | null;
  returning: boolean;
  bound_for: string | null;
  at_start: boolean;
  guiding: "offered" | "on" | "own" | null;
  lost: boolean;
  let_go_first: boolean;
  idle_left_s: number | null;
  mode: "latent" | "assisted" | "end_effector";
  axes: number;
  help: "off" | "low" | "medium" | "high" | null;
  profile: string | null;
  tool: [number, number, number];
  gripper: GripperState | null;
  held: string[];
  task: TaskState;
  things: Things | null;
  ghosts: Ghosts | null;
  alpha: number;
  late_share: number;
  recording: Recording | null;
  type: "state";
  bodies: number[][];
  belief: number[] | null;
  driver: string | null;
  driver_name: string | number | null;
  watchers: number;
  asking: string | null;
  asking_name: string | number | null;
  copilot: CopilotState | null;
  copilot_asking: Person | null;
  trail: number;
  arm_start: number;
  you: boolean;
}

export interface StepToDo {
  kind: "approached" | "reached" | "passed" | "holding" | "stabbed" | "above" | "poured" | "cut" | "scooped" | "dipped" | "stirred" | "placed";
  thing: string;
}

export interface TaskState {
  choice: number;
  done: number;
  outcome: "success" | "failure" | null;
  why: Why | null;
  time_s: number;
  to_go: ToGo | null;
  lost: Lost | null;
  fills: Fill[];
  short: boolean;
}

export interface TaskToDo {
  name: string;
  seed: number;
  choices: string[];
  choice: number;
  steps: StepToDo[];
}

export interface Things {
  poses: [number, number, number, number, number, number, number][];
  grains: number[][];
  seen: SeenThing[];
}

export interface ToGo {
  shift_m: [number, number, number];
  turn_rad: [number, number, number];
  gripper: "open" | "close" | null;
}

export interface TouchThing {
  type: "touch";
  thing: string;
  kind: "place" | "front" | "undo";
}

export interface Trace {
  version: 1;
  period_s: number;
  t: number[];
  q: number[][];
  tool: [number, number, number][];
  bodies: [number, number, number, number, number, number, number][][];
  u: number[][];
  width_m: (number | null)[];
  things: TracedThings[];
  marks: Mark[];
}

export interface TracedThings {
  t: number;
  poses: [number, number, number, number, number, number, number][];
  grains: number[][] | null;
}

export interface Train {
  type: "train";
  name: string;
  model: string;
  latent_dim: 1 | 2;
  episodes: ChosenEpisode[];
}

export interface Training {
  phase: "exporting" | "training" | "done" | "failed" | "cancelled";
  run: string;
  epoch: number;
  epochs: number;
  loss: number | null;
  seconds_left: number | null;
  why: Notice[];
  lesson: Lesson | null;
}

export interface Welcome {
  type: "welcome";
  version: 1;
  id: string;
  server: string;
  dof: number;
  latent_dim: number;
  robot: string;
  run: string | null;
  profiles: string[];
  modes: ("latent" | "assisted" | "end_effector")[];
  goals: NamedPlace[];
  things: NamedPlace[];
  zones: NamedZone[];
  keep_out: string[];
  end_effector_modes: string[];
  latch_max_s: number;
  gripper_width_m: number | null;
  task: TaskToDo;
  real: RealArm | null;
  poses: ("home" | "tuck")[];
}

export interface Why {
  code: "dropped" | "knocked_over" | "spilled" | "pressed";
  thing: string;
}

export type ClientMessage = Hello | DriverInput | ConfirmChecklist | Press | PressStop | HandOver | RecordEpisode | MotionWithoutStick | GoToPose | EditPoses | Train | PickRun | BeginPersonalise | AnswerQuestion | LeaveQuestion | PressPersonalise | PressCopilot | CopilotPace | ChooseMode | ChooseHelp | ChooseProfile | KeepGuiding | Reconnect | TouchThing | Reset | BeginTask;

export type ServerMessage = Welcome | State | LearningState | Poses | Refused;
