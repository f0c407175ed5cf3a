/** Types that most modules of the page name: known everywhere, so that nobody need import them. */

type Connection = import("./connection/connection.js").Connection;
type DriverLease = import("./connection/driver_lease.js").DriverLease;
type ClientMessage = import("./connection/messages.js").ClientMessage;
type LearningState = import("./connection/messages.js").LearningState;
type Notice = import("./connection/messages.js").Notice;
type State = import("./connection/messages.js").State;
type Welcome = import("./connection/messages.js").Welcome;
type Drive = import("./history/weeks.js").Drive;
type Direction = import("./inputs/deflection.js").Direction;
type HaltReason = import("./inputs/deflection.js").HaltReason;
type PersonInput = import("./inputs/deflection.js").PersonInput;
type DriveInput = import("./inputs/drive_input.js").DriveInput;
type Choice = import("./inputs/scanner.js").Choice;
type Group = import("./inputs/scanner.js").Group;
type Source = import("./inputs/deflection.js").Source;
type Scanner = import("./inputs/scanner.js").Scanner;
type Personalise = import("./connection/messages.js").Personalise;
type ArmScene = import("./views/scene.js").ArmScene;
type Words = import("./connection/sentence.js").Words;
type WordKey = import("./layout/words.js").WordKey;
type Settings = import("./settings/settings.js").Settings;
type Values = import("./settings/settings.js").Values;
type Drawing = import("./views/drawing.js").Drawing;
type Paths = import("./views/predictions.js").Paths;
/** From the stick, right and up, to what is sent. */
type Shaped = (x: number, y: number) => number[];
