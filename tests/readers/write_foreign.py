"""Writes one motion in the formats of other programs, each by its own library.

The truth is truth.csv: t_s, motor_speed_rad_s, torque_Nm. Files hold rpm and mN m.
"""

import json
import pathlib
import shutil
import struct
import sys

import can
import cantools
import h5py
import numpy as np
import pyarrow as pa
import pyarrow.feather
import pyarrow.parquet
import scipy.io
from asammdf import MDF, Signal
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory, timestamp_pb2
from mcap.writer import Writer
from mcap_protobuf.writer import Writer as ProtobufWriter
from mcap_ros2.writer import Writer as RosWriter
from nptdms import ChannelObject, TdmsWriter
from pyulog import ULog
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from wpiutil import DataLogWriter
from wpiutil.log import DoubleLogEntry

folder = pathlib.Path(sys.argv[1])
ROWS = 2000
START_NS = 1_714_564_800_000_000_000
t = np.arange(ROWS) * 1e-3
speed_rad_s = 40 * np.sin(3 * t)
torque_Nm = 0.25 * np.cos(5 * t)
rpm = speed_rad_s * 60 / (2 * np.pi)
mNm = torque_Nm * 1e3
rows = np.column_stack([t, speed_rad_s, torque_Nm])
np.savetxt(folder / "truth.csv", rows, delimiter=",", fmt="%.17g", header="t_s,motor_speed_rad_s,torque_Nm", comments="")


def tdms(name, **how):
    waveform = {"wf_increment": 1e-3, "wf_start_offset": 0.0, "wf_start_time": np.datetime64(START_NS, "ns")}
    with TdmsWriter(folder / name, **how) as file:
        # A new segment for the second half: what LabVIEW does for each write.
        for part in (slice(0, 700), slice(700, ROWS)):
            file.write_segment([
                ChannelObject("DAQ", "Motor speed", rpm[part], {**waveform, "unit_string": "rpm"}),
                ChannelObject("DAQ", "Torque", mNm[part], {**waveform, "unit_string": "mN m"}),
            ])


def mdf(name, compression):
    file = MDF(version="4.10")
    file.append([Signal(rpm, t, name="Motor speed", unit="rpm"), Signal(mNm, t, name="Torque", unit="mNm")])
    file.save(folder / name, overwrite=True, compression=compression)


def arrow():
    stamps = pa.array(START_NS + np.round(t * 1e9).astype("int64"), pa.timestamp("ns", "UTC"))
    table = pa.table({"time": stamps, "motor_speed_rpm": rpm, "torque [mNm]": mNm, "operator": ["x"] * ROWS})
    pa.parquet.write_table(table, folder / "run.parquet", compression="zstd", row_group_size=600)
    pa.feather.write_feather(table, folder / "run.feather")
    with pa.OSFile(str(folder / "run.arrows"), "wb") as sink, pa.ipc.new_stream(sink, table.schema) as stream:
        stream.write_table(table)


def matlab():
    log = {"time_s": t[:, None], "motor_speed_rpm": rpm[None, :], "torque_mNm": mNm[:, None], "note": "bench 3"}
    scipy.io.savemat(folder / "run.mat", log, do_compression=True)
    # MATLAB 7.3 is HDF5 behind 512 bytes of its own, with rows and columns exchanged.
    with h5py.File(folder / "run73.mat", "w", userblock_size=512) as file:
        for name in ("time_s", "motor_speed_rpm", "torque_mNm"):
            data = file.create_dataset(name, data=np.asarray(log[name]).reshape(1, -1), chunks=(1, 500), compression="gzip")
            data.attrs["MATLAB_class"] = np.bytes_("double")
    with open(folder / "run73.mat", "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    with h5py.File(folder / "run.h5", "w") as file:
        for name, values, unit in (("time", t, "s"), ("motor_speed", rpm, "rpm"), ("torque", mNm, "mN m")):
            file[f"bench/{name}"] = values
            file[f"bench/{name}"].attrs["units"] = unit


def ros():
    schema = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
    header = "=" * 80 + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    time = "=" * 80 + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
    with open(folder / "ros.mcap", "wb") as file:
        writer = RosWriter(file)
        kind = writer.register_msgdef("sensor_msgs/msg/JointState", schema + header + time)
        for k in range(ROWS):
            stamp = START_NS + round(t[k] * 1e9)
            message = {
                "header": {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}, "frame_id": ""},
                "name": ["motor", "load"],
                "position": [0.0, 1.0],
                "velocity": [speed_rad_s[k], 0.5 * speed_rad_s[k]],
                "effort": [torque_Nm[k], 0.0],
            }
            # Messages arrive late, and now and then in another order.
            late = 2_500_000 if k % 7 == 0 else 0
            writer.write_message("/joint_states", kind, message, log_time=stamp + late, publish_time=stamp)
        writer.finish()
    with open(folder / "json.mcap", "wb") as file:
        writer = Writer(file)
        writer.start()
        kind = writer.register_schema("State", "jsonschema", b'{"type": "object"}')
        channel = writer.register_channel("/state", "json", kind)
        for k in range(ROWS):
            data = json.dumps({"speed_rpm": rpm[k], "load": {"torque_mNm": mNm[k]}}).encode()
            writer.add_message(channel, START_NS + round(t[k] * 1e9), data, START_NS + round(t[k] * 1e9))
        writer.finish()


def protobuf():
    file = descriptor_pb2.FileDescriptorProto(name="bench.proto", package="lab", syntax="proto3")
    file.dependency.append(timestamp_pb2.DESCRIPTOR.name)
    message = file.message_type.add(name="State")
    kinds = descriptor_pb2.FieldDescriptorProto
    message.field.add(name="stamp", number=1, type=kinds.TYPE_MESSAGE, type_name=".google.protobuf.Timestamp", label=1)
    message.field.add(name="motor_speed_rpm", number=2, type=kinds.TYPE_DOUBLE, label=1)
    message.field.add(name="torque_mNm", number=3, type=kinds.TYPE_DOUBLE, label=1)
    pool = descriptor_pool.Default()
    pool.Add(file)
    State = message_factory.GetMessageClass(pool.FindMessageTypeByName("lab.State"))
    with open(folder / "protobuf.mcap", "wb") as out, ProtobufWriter(out) as writer:
        for k in range(ROWS):
            stamp = START_NS + round(t[k] * 1e9)
            state = State(motor_speed_rpm=rpm[k], torque_mNm=mNm[k])
            state.stamp.FromNanoseconds(stamp)
            writer.write_message("/state", state, log_time=stamp + 1_700_000, publish_time=stamp)


def wpilog():
    log = DataLogWriter(str(folder / "run.wpilog"))
    entries = [DoubleLogEntry(log, "/Drive/motor_speed_rpm"), DoubleLogEntry(log, "/Drive/torque", '{"unit": "mN m"}')]
    for k in range(ROWS):
        for entry, values in zip(entries, (rpm, mNm)):
            # A time of zero would mean now.
            entry.append(values[k], 1_000_000 + 1000 * k)
    log.stop()


def ulog():
    """pyulog writes what it has read: the first file is made by hand."""

    def message(kind, payload):
        return struct.pack("<HB", len(payload), ord(kind)) + payload

    first = folder / "first.ulg"
    with open(first, "wb") as file:
        file.write(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0))
        file.write(message("B", bytes(40)))
        file.write(message("F", b"axis:double motor_speed_rpm;uint8_t load;uint8_t[7] _padding0;"))
        file.write(message("F", b"drive:uint64_t timestamp;axis axis;double torque_mNm;"))
        file.write(message("A", struct.pack("<BH", 0, 3) + b"drive"))
        for k in range(ROWS):
            file.write(message("D", struct.pack("<HQdB7xd", 3, 1000 * k, rpm[k], 1, mNm[k])))
    ULog(str(first)).write_ulog(str(folder / "run.ulg"))


def bus():
    """Frames of CAN FD with two numbers of 64 bits, and short frames that cantools decodes."""
    fd = cantools.database.load_string(
        """VERSION ""
BU_: Bench
BO_ 256 Drive: 16 Bench
 SG_ motor_speed : 0|64@1- (1,0) [0|0] "rpm" Bench
 SG_ torque : 71|64@0- (1,0) [0|0] "mNm" Bench
SIG_VALTYPE_ 256 motor_speed : 2;
SIG_VALTYPE_ 256 torque : 2;
"""
    )
    (folder / "can").mkdir()
    cantools.database.dump_file(fd, folder / "can" / "bench.dbc")
    writers = {name: can.Logger(folder / "can" / name) for name in ("run.log", "run.asc", "run.blf")}
    for k in range(ROWS):
        data = fd.encode_message("Drive", {"motor_speed": rpm[k], "torque": mNm[k]})
        # Small, so that python-can's seconds keep their digits.
        stamp = 1.0 + 1e-3 * k
        frame = can.Message(timestamp=stamp, arbitration_id=256, is_extended_id=False, is_fd=True, data=data, channel=0)
        for writer in writers.values():
            writer(frame)
    for writer in writers.values():
        writer.stop()
    # First bit (the last one where the first byte counts least) and number of bits.
    intel, motorola = [(0, 64), (3, 13), (20, 1), (9, 33), (55, 8)], [(7, 64), (3, 13), (20, 1), (14, 33), (55, 8)]
    places = [(place, order, sign) for order, places in ((1, intel), (0, motorola)) for place in places for sign in "+-"]
    lines = [
        f' SG_ s{at} : {start}|{bits}@{order}{sign} ({0.25 * (at + 1)},{at - 3}) [0|0] "V" Bench'
        for at, ((start, bits), order, sign) in enumerate(places)
    ]
    # Each in a message of its own, so that signals may share bits.
    text = 'VERSION ""\nBU_: Bench\n' + "".join(f"BO_ {at + 1} M{at}: 8 Bench\n{line}\n\n" for at, line in enumerate(lines))
    (folder / "signals").mkdir()
    (folder / "signals" / "signals.dbc").write_text(text)
    signals = cantools.database.load_string(text)
    random = np.random.default_rng(7)
    table = []
    with can.Logger(folder / "signals" / "signals.log") as writer:
        for k in range(200):
            row = [1e-2 * k]
            for at in range(len(places)):
                data = random.bytes(8)
                writer(can.Message(timestamp=1.0 + 1e-2 * k, arbitration_id=at + 1, is_extended_id=False, data=data, channel="can0"))
                row.append(signals.decode_message(at + 1, data)[f"s{at}"])
            table.append(row)
    header = ",".join(["t_s", *(f"s{at}_V" for at in range(len(places)))])
    np.savetxt(folder / "signals" / "truth.csv", table, delimiter=",", fmt="%.17g", header=header, comments="")


def bag():
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg("builtin_interfaces/Time stamp\nfloat64 motor_speed_rpm\nfloat64 torque_mNm\n", "bench_msgs/msg/State"))
    Time, State = (store.types[name] for name in ("builtin_interfaces/msg/Time", "bench_msgs/msg/State"))
    with BagWriter(folder / "bag", version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection("/state", State.__msgtype__, typestore=store)
        for k in range(ROWS):
            stamp = START_NS + round(t[k] * 1e9)
            message = State(Time(stamp // 10**9, stamp % 10**9), rpm[k], mNm[k])
            writer.write(connection, stamp + 400_000, store.serialize_cdr(message, State.__msgtype__))
    shutil.move(folder / "bag" / "bag.db3", folder / "run.db3")


tdms("run.tdms")
mdf("run.mf4", 0)
mdf("compressed.mf4", 2)
arrow()
matlab()
protobuf()
ros()
wpilog()
ulog()
bus()
bag()
