// `node main.mjs [gearmotor] FIRMWARE.elf [FLASHED.uf2]`: the board behind two TCP ports of this machine, which it prints on standard error. On the first one a
// host talks to it as over USB; on the second one a test asks and does things, a line of JSON each way. Standard input and output
// belong to the bench (bench.mjs).
//
// Time passes as fast as it can, but while a host is connected never further ahead than the host keeps up, unless told otherwise.

import { readFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { createInterface } from 'node:readline';
import { Board } from './board.mjs';
import { damage } from './damage.mjs';
import { Flips } from './flips.mjs';
import { GearmotorBoard } from './gearmotor.mjs';

const TURN_NS = 2_000_000;
// Well before the board misses its host.
const LEAD_NS = 200_000_000;
const ENUMERATED_NS = 400_000_000;

const state = { host: null, heardNs: 0, patient: true, toBoard: damage(), toHost: damage(), owed: [], keep: false, said: [] };

const isGearmotor = process.argv[2] === 'gearmotor';
const Kind = isGearmotor ? GearmotorBoard : Board;
const [image, flashed] = process.argv.slice(isGearmotor ? 3 : 2).map((file) => readFileSync(file));
const board = new Kind(image, flashed ?? image, (bytes) => {
  if (state.keep) state.said.push(Buffer.from(bytes));
  if (state.host && !state.host.destroyed) state.host.write(state.toHost.pass(bytes));
});

const link = createServer((socket) => {
  socket.setNoDelay(true);
  state.host = socket;
  state.heardNs = board.nanos;
  socket.on('data', (bytes) => {
    state.heardNs = board.nanos;
    const said = board.hostSays === 'garbage' ? bytes.map(() => Math.floor(Math.random() * 256)) : bytes;
    if (board.hostSays !== 'nothing') board.usb.say(state.toBoard.pass(said));
  });
  const gone = () => {
    if (state.host === socket) state.host = null;
  };
  socket.on('close', gone);
  socket.on('error', gone);
});

const control = createServer((socket) => {
  createInterface({ input: socket }).on('line', (line) => {
    const { ask, ...more } = JSON.parse(line);
    const answer = (value) => socket.write(`${JSON.stringify(value)}\n`);
    switch (ask) {
      case 'inject':
        board.inject(more);
        return answer({});
      case 'log':
        return answer(board.log);
      case 'measured':
        return answer(board.measured(more.stepUs));
      case 'reset-measured':
        board.resetMeasure();
        return answer({});
      case 'patient':
        state.patient = more.patient;
        return answer({});
      case 'damage':
        state.toBoard = damage(more.toBoard, more.seed, () => board.enabled);
        state.toHost = damage(more.toHost, more.seed + 1, () => board.enabled);
        return answer({});
      case 'damaged':
        return answer({ toBoard: state.toBoard.counts, toHost: state.toHost.counts });
      case 'keep':
        state.keep = true;
        return answer({});
      case 'said':
        return answer(Buffer.concat(state.said).toString('hex'));
      case 'flip':
        state.flips = { flips: new Flips(board, more), answer };
        return undefined;
      case 'run':
        state.owed.push({ untilNs: board.nanos + more.forS * 1e9, answer });
        return undefined;
      default:
        return answer({ error: `nothing is known of ${ask}` });
    }
  });
  socket.on('error', () => {});
});

function turn() {
  const owes = state.owed.length > 0 || state.flips !== undefined;
  const hostKeepsUp = state.host !== null && (!state.patient || board.nanos - state.heardNs < LEAD_NS || !board.enabled);
  if (owes || hostKeepsUp) {
    if (board.hostSays === 'chatter') board.chatter(TURN_NS);
    if (!state.flips) board.runFor(TURN_NS);
    else if (!state.flips.flips.next()) {
      state.flips.answer(state.flips.flips.outcome);
      state.flips = undefined;
    }
    state.owed = state.owed.filter(({ untilNs, answer }) => {
      if (board.nanos < untilNs) return true;
      answer({ ns: board.nanos });
      return false;
    });
    setImmediate(turn);
  } else {
    setTimeout(turn, 1);
  }
}

// Whoever started it is gone.
const parent = process.ppid;
setInterval(() => process.ppid === parent || process.exit(), 1000);

// It runs slower than time: it has enumerated before a host waits for it.
if (isGearmotor) board.runFor(ENUMERATED_NS);

link.listen(0, '127.0.0.1', () => {
  control.listen(0, '127.0.0.1', () => {
    process.stderr.write(`listening on ${link.address().port} and ${control.address().port}\n`);
    turn();
  });
});
