"""Recordings by an independent implementation of ROS 2's messages (`pip install rosbags`), for recordings.rs.

write FOLDER JOB.json   images as a bag: {"pairs": [[left, right, left_ns, right_ns]], "encoding", "compression", "rig", "topics", "scramble", "detections"}
foxglove FILE JOB.json  the same as Foxglove's own messages (`pip install foxglove-schemas-protobuf mcap-protobuf-support`)
read FILE.mcap          every message as a line of JSON, by the official definitions; the file's own definitions have to equal them
"""

import json
import sys
from pathlib import Path

import numpy as np
from rosbags.rosbag2 import Reader, Writer
from rosbags.rosbag2.enums import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
# vision_msgs 4, which the store lacks: https://github.com/ros-perception/vision_msgs.
VISION = {
    'Point2D': 'float64 x\nfloat64 y\n',
    'Pose2D': 'vision_msgs/Point2D position\nfloat64 theta\n',
    'BoundingBox2D': 'vision_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y\n',
    'BoundingBox3D': 'geometry_msgs/Pose center\ngeometry_msgs/Vector3 size\n',
    'ObjectHypothesis': 'string class_id\nfloat64 score\n',
    'ObjectHypothesisWithPose': 'vision_msgs/ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose\n',
    'Detection2D': 'std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\nvision_msgs/BoundingBox2D bbox\nstring id\n',
    'Detection2DArray': 'std_msgs/Header header\nvision_msgs/Detection2D[] detections\n',
    'Detection3D': 'std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\nvision_msgs/BoundingBox3D bbox\nstring id\n',
    'Detection3DArray': 'std_msgs/Header header\nvision_msgs/Detection3D[] detections\n',
}
for name, text in VISION.items():
    STORE.register(get_types_from_msg(text, f'vision_msgs/msg/{name}'))
TYPES = STORE.types


def pgm(path):
    """Grey values of an 8-bit PGM file."""
    magic, width, height, _, pixels = Path(path).read_bytes().split(maxsplit=4)
    assert magic == b'P5'
    size = int(width) * int(height)
    # A pixel may look like white space behind the header: the last ones are the image.
    return np.frombuffer(Path(path).read_bytes()[-size:], np.uint8).reshape(int(height), int(width))


def header(ns, frame):
    time = TYPES['builtin_interfaces/msg/Time'](sec=ns // 10**9, nanosec=ns % 10**9)
    return TYPES['std_msgs/msg/Header'](stamp=time, frame_id=frame)


def image(path, ns, frame, encoding):
    if encoding == 'file':
        data = np.frombuffer(Path(path).read_bytes(), np.uint8)
        kind = 'sensor_msgs/msg/CompressedImage'
        return kind, TYPES[kind](header=header(ns, frame), format=Path(path).suffix[1:], data=data)
    grey = pgm(path)
    height, width = grey.shape
    name, big = encoding.removesuffix('be'), encoding.endswith('be')
    if name == 'mono16':
        # The same when rounded to 8 bits, another value in the other byte order.
        wide = np.minimum(grey.astype(np.uint32) * 257 + 100, 65535)
        rows = wide.astype('>u2' if big else '<u2').view(np.uint8)
    elif name in ('rgb8', 'bgr8'):
        rows = np.repeat(grey, 3, axis=1)
    elif name.startswith('yuv422'):
        colour = np.full_like(grey, 77)
        rows = np.stack([grey, colour] if name == 'yuv422_yuy2' else [colour, grey], axis=2)
    else:
        rows = grey
    # Rows that are longer than their pixels.
    rows = np.pad(rows.reshape(height, -1), ((0, 0), (0, 5 if name == 'mono8' else 0)))
    kind = 'sensor_msgs/msg/Image'
    return kind, TYPES[kind](header=header(ns, frame), height=height, width=width, encoding=name,
                             is_bigendian=int(big), step=rows.shape[1], data=np.ascontiguousarray(rows).reshape(-1))


def camera_info(rig, ns, frame, is_right):
    f, (cx, cy) = rig['focal_px'], rig['centre']
    cx += rig.get('offset_px', 0) if is_right else 0
    roi = TYPES['sensor_msgs/msg/RegionOfInterest'](x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
    p = np.array([f, 0, cx, -f * rig['baseline_m'] if is_right else 0, 0, f, cy, 0, 0, 0, 1, 0], float)
    k = np.array([f, 0, cx, 0, f, cy, 0, 0, 1], float)
    return TYPES['sensor_msgs/msg/CameraInfo'](
        header=header(ns, frame), height=rig['size'][1], width=rig['size'][0], distortion_model='plumb_bob',
        d=np.array(rig.get('lens', [0] * 5), float), k=k, r=np.eye(3).reshape(-1), p=p, binning_x=0, binning_y=0, roi=roi)


def detections(boxes, ns):
    def kind(name):
        return TYPES[f'vision_msgs/msg/{name}']

    def found(x, y, w, h, name):
        pose, zero = TYPES['geometry_msgs/msg/Pose'], TYPES['geometry_msgs/msg/Point'](x=0.0, y=0.0, z=0.0)
        pose = pose(position=zero, orientation=TYPES['geometry_msgs/msg/Quaternion'](x=0.0, y=0.0, z=0.0, w=1.0))
        pose = TYPES['geometry_msgs/msg/PoseWithCovariance'](pose=pose, covariance=np.zeros(36))
        said = [kind('ObjectHypothesis')(class_id=f'not {name}', score=0.1), kind('ObjectHypothesis')(class_id=name, score=0.8)]
        results = [kind('ObjectHypothesisWithPose')(hypothesis=one, pose=pose) for one in said]
        centre = kind('Pose2D')(position=kind('Point2D')(x=float(x), y=float(y)), theta=0.0)
        box = kind('BoundingBox2D')(center=centre, size_x=float(w), size_y=float(h))
        return kind('Detection2D')(header=header(ns, 'left_optical'), results=results, bbox=box, id='track')

    return kind('Detection2DArray')(header=header(ns, 'left_optical'), detections=[found(*box) for box in boxes])


def write(folder, job):
    writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
    if job['compression'] == 'zstd':
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        connections, messages = {}, []
        for left, right, *stamps in job['pairs']:
            for side, (path, ns) in enumerate(zip((left, right), stamps)):
                frame = ['left_optical', 'right_optical'][side]
                if path:
                    messages.append((ns, job['topics'][side], *image(path, ns, frame, job['encoding'])))
                if job.get('rig'):
                    topic = job['topics'][side].removesuffix('/compressed').rsplit('/', 1)[0] + '/camera_info'
                    info = camera_info(job['rig'], ns, frame, side == 1)
                    messages.append((ns, topic, 'sensor_msgs/msg/CameraInfo', info))
            if job.get('detections'):
                said = detections(job['detections']['boxes'], stamps[0])
                messages.append((stamps[0], job['detections']['topic'], 'vision_msgs/msg/Detection2DArray', said))
        if job.get('scramble'):
            messages.reverse()
        for ns, topic, kind, message in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            writer.write(connections[topic], ns, STORE.serialize_cdr(message, kind))


def foxglove(path, job):
    """The same job in Foxglove's own schemas, by its own packages."""
    from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
    from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
    from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
    from mcap_protobuf.writer import Writer as Protobuf

    with open(path, 'wb') as file, Protobuf(file) as writer:
        for left, right, *stamps in job['pairs']:
            for side, (image_path, ns) in enumerate(zip((left, right), stamps)):
                topic, frame = job['topics'][side], ['left_optical', 'right_optical'][side]
                kind, same = image(image_path, ns, frame, job['encoding'])
                if kind.endswith('CompressedImage'):
                    message = CompressedImage(format=same.format, frame_id=frame, data=same.data.tobytes())
                else:
                    message = RawImage(width=same.width, height=same.height, encoding=same.encoding, step=same.step,
                                       frame_id=frame, data=same.data.tobytes())
                message.timestamp.FromNanoseconds(ns)
                writer.write_message(topic, message, log_time=ns)
                info = camera_info(job['rig'], ns, frame, side == 1)
                message = CameraCalibration(width=info.width, height=info.height, distortion_model='plumb_bob', D=info.d,
                                            K=info.k, R=info.r, P=info.p, frame_id=frame)
                message.timestamp.FromNanoseconds(ns)
                writer.write_message(topic.rsplit('/', 1)[0] + '/calibration', message, log_time=ns)


def plain(value):
    """A message as JSON."""
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, float) and not np.isfinite(value):
        return None if np.isnan(value) else 'infinite'
    if hasattr(value, '__dataclass_fields__'):
        return {name: plain(getattr(value, name)) for name in value.__dataclass_fields__ if name != '__msgtype__'}
    if isinstance(value, list):
        return [plain(item) for item in value]
    return value


def read(path):
    with Reader(path) as reader:
        for connection in reader.connections:
            # All that the definition in the file names is as in the official ones.
            text = connection.msgdef.data
            for name, fields in get_types_from_msg(text, connection.msgtype).items():
                assert fields == STORE.fielddefs[name], name
        for connection, ns, data in reader.messages():
            message = STORE.deserialize_cdr(data, connection.msgtype)
            assert bytes(STORE.serialize_cdr(message, connection.msgtype)) == bytes(data), connection.topic
            line = {'topic': connection.topic, 'type': connection.msgtype, 'ns': ns, 'message': plain(message)}
            if connection.msgtype == 'sensor_msgs/msg/PointCloud2':
                line['points'] = np.frombuffer(message.data, '<f4').reshape(-1, message.point_step // 4).tolist()
                del line['message']['data']
            if connection.msgtype == 'stereo_msgs/msg/DisparityImage':
                line['disparities'] = np.frombuffer(message.image.data, '<f4').tolist()
                del line['message']['image']['data']
            print(json.dumps(line))
        count = reader.message_count
    again(path, count)


def again(path, count):
    """The same by Foxglove's own reader, where it is installed."""
    try:
        from mcap.reader import make_reader
        from mcap_ros2.decoder import DecoderFactory
    except ImportError:
        return
    with open(path, 'rb') as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == 'ros2'
        assert sum(1 for _ in reader.iter_decoded_messages()) == count
        summary = reader.get_summary()
        assert summary.statistics.message_count == count
        assert len(summary.schemas) == summary.statistics.schema_count
        assert len(summary.channels) == summary.statistics.channel_count
        assert len(summary.chunk_indexes) == summary.statistics.chunk_count
    print(json.dumps({'topic': 'Foxglove reads it too'}))


if sys.argv[1] == 'write':
    write(Path(sys.argv[2]), json.loads(Path(sys.argv[3]).read_text()))
elif sys.argv[1] == 'foxglove':
    foxglove(Path(sys.argv[2]), json.loads(Path(sys.argv[3]).read_text()))
else:
    read(Path(sys.argv[2]))
