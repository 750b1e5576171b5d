"""Writes one motion in the formats of other programs, each by its own library.

The truth is truth.csv: t_s, motor_speed_rad_s, torque_Nm. Files hold rpm and mN m.
"""

import json
import pathlib
import sys

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


tdms("run.tdms")
mdf("run.mf4", 0)
mdf("compressed.mf4", 2)
arrow()
matlab()
protobuf()
ros()
