# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Reads a recording of ROS 2 by the specifications of MCAP and CDR, with Debian's parser of .msg.

mcap_reader.py FILE prints what it holds as JSON. Fails where the file breaks a rule of MCAP's: all
lengths, offsets, counts, indexes and checksums are compared with what they tell of.
"""
import json
import re
import struct
import sys
import zlib

import zstandard
from rosidl_adapter.parser import parse_message_string

MAGIC = b'\x89MCAP0\r\n'
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
STATISTICS, SUMMARY_OFFSET, DATA_END = 11, 14, 15
FORMATS = {'bool': '?', 'byte': 'B', 'char': 'B', 'float32': 'f', 'float64': 'd', 'int8': 'b',
           'uint8': 'B', 'int16': 'h', 'uint16': 'H', 'int32': 'i', 'uint32': 'I', 'int64': 'q',
           'uint64': 'Q'}


class Fields:
    """The fields of a record, one after the other."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, size):
        assert self.at + size <= len(self.data)
        self.at += size
        return self.data[self.at - size:self.at]

    def number(self, form):
        return struct.unpack('<' + form, self.take(struct.calcsize('<' + form)))[0]

    def text(self):
        return self.take(self.number('I')).decode()

    def pairs(self, first, second):
        """A map or an array of pairs."""
        inner, result = Fields(self.take(self.number('I'))), []
        while inner.at < len(inner.data):
            result.append(tuple(inner.text() if form == 's' else inner.number(form)
                                for form in (first, second)))
        return result

    def rest(self):
        return self.take(len(self.data) - self.at)


def records(data, at, end):
    """(offset, opcode, content, whole record) of all from `at` to exactly `end`."""
    while at < end:
        opcode, length = struct.unpack_from('<BQ', data, at)
        assert at + 9 + length <= end
        yield at, opcode, data[at + 9:at + 9 + length], data[at:at + 9 + length]
        at += 9 + length
    assert at == end


def schema_of(content):
    fields = Fields(content)
    return fields.number('H'), {'name': fields.text(), 'encoding': fields.text(),
                                'text': fields.text()}


def channel_of(content):
    fields = Fields(content)
    return fields.number('H'), {'schema': fields.number('H'), 'topic': fields.text(),
                                'encoding': fields.text(), 'metadata': dict(fields.pairs('s', 's'))}


class Data:
    """What stands before the summary, read in its order, as if there were no index."""

    def __init__(self, file):
        self.schemas, self.channels, self.messages = {}, {}, []
        self.chunk_indexes = []  # as they should be
        self.of_chunk = None
        listing = records(file, len(MAGIC), len(file) - len(MAGIC))
        _, opcode, content, _ = next(listing)
        assert opcode == HEADER
        header = Fields(content)
        self.profile, self.library = header.text(), header.text()
        for at, opcode, content, whole in listing:
            if opcode == CHUNK:
                self.chunk(at, content, len(whole))
            elif opcode == MESSAGE_INDEX:
                self.message_index(at, content, len(whole))
            elif opcode == DATA_END:
                self.end = at + len(whole)
                break
            else:
                raise ValueError(f'opcode {opcode} outside of chunks')

    def chunk(self, at, content, length):
        fields = Fields(content)
        begin, end, size, crc = (fields.number(form) for form in 'QQQI')
        compression = fields.text()
        packed = fields.take(fields.number('Q'))
        assert fields.rest() == b'' and compression == 'zstd'
        plain = zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
        assert len(plain) == size and crc == zlib.crc32(plain)
        self.of_chunk = {}
        for offset, opcode, inner, _ in records(plain, 0, size):
            if opcode == SCHEMA:
                number, schema = schema_of(inner)
                assert number > 0 and number not in self.schemas
                self.schemas[number] = schema
            elif opcode == CHANNEL:
                number, channel = channel_of(inner)
                assert channel['schema'] in self.schemas and number not in self.channels
                self.channels[number] = channel
            else:
                assert opcode == MESSAGE
                self.message(Fields(inner), offset)
        times = [time for messages in self.of_chunk.values() for time, _ in messages]
        assert (begin, end) == (min(times), max(times))
        self.chunk_indexes.append(
            {'times': (begin, end), 'at': at, 'length': length, 'offsets': {}, 'index_length': 0,
             'compression': compression, 'sizes': (len(packed), size)})

    def message(self, fields, offset):
        number, _, log, publish = (fields.number(form) for form in 'HIQQ')
        channel = self.channels[number]
        self.of_chunk.setdefault(number, []).append((log, offset))
        self.messages.append({'topic': channel['topic'], 'channel': number, 'log_time': log,
                              'publish_time': publish, 'cdr': fields.rest()})

    def message_index(self, at, content, length):
        fields = Fields(content)
        number = fields.number('H')
        assert fields.pairs('Q', 'Q') == self.of_chunk.pop(number)
        index = self.chunk_indexes[-1]
        assert at == index['at'] + index['length'] + index['index_length']
        index['offsets'][number] = at
        index['index_length'] += length


def check_summary(file, data):
    footer_at = len(file) - len(MAGIC) - 29
    (_, opcode, content, whole), = records(file, footer_at, len(file) - len(MAGIC))
    start, offsets_start, crc = struct.unpack('<QQI', content)
    assert opcode == FOOTER and start == data.end
    assert crc == zlib.crc32(file[start:footer_at] + whole[:-4])
    groups = {}
    schemas, channels, indexes = {}, {}, []
    for at, opcode, content, whole in records(file, start, offsets_start):
        begin, length = groups.get(opcode, (at, 0))
        assert begin + length == at
        groups[opcode] = (begin, length + len(whole))
        fields = Fields(content)
        if opcode == SCHEMA:
            schemas.update([schema_of(content)])
        elif opcode == CHANNEL:
            channels.update([channel_of(content)])
        elif opcode == CHUNK_INDEX:
            times = (fields.number('Q'), fields.number('Q'))
            indexes.append({'times': times, 'at': fields.number('Q'), 'length': fields.number('Q'),
                            'offsets': dict(fields.pairs('H', 'Q')),
                            'index_length': fields.number('Q'), 'compression': fields.text(),
                            'sizes': (fields.number('Q'), fields.number('Q'))})
        elif opcode == STATISTICS:
            counts = [fields.number(form) for form in 'QHIIIIQQ']
            per_channel = dict(fields.pairs('H', 'Q'))
    assert indexes == data.chunk_indexes
    assert schemas.items() >= data.schemas.items() and channels.items() >= data.channels.items()
    times = [message['log_time'] for message in data.messages] or [0]
    assert counts == [len(data.messages), len(schemas), len(channels), 0, 0, len(indexes),
                      min(times), max(times)]
    assert per_channel == {number: sum(m['channel'] == number for m in data.messages)
                           for number in channels}
    offsets = {}
    for _, opcode, content, _ in records(file, offsets_start, footer_at):
        assert opcode == SUMMARY_OFFSET
        group, begin, length = struct.unpack('<BQQ', content)
        offsets[group] = (begin, length)
    assert offsets == groups


class Cdr:
    """Decodes messages of the type that a definition tells of; XCDR1, little-endian."""

    def __init__(self, type_name, text):
        parts = re.split(r'={80}\nMSG: (\S+)\n', text)
        self.name = type_name.replace('/msg/', '/')
        self.types = {name: parse_message_string(*name.split('/'), body).fields
                      for name, body in zip([self.name, *parts[1::2]], parts[0::2])}

    def decode(self, cdr):
        assert cdr[:4] == b'\x00\x01\x00\x00'
        self.body, self.at = cdr[4:], 0
        message = self.struct(self.name)
        assert len(self.body) - self.at < 4  # what DDS pads
        return message

    def struct(self, name):
        return {field.name: self.field(field.type) for field in self.types[name]}

    def field(self, type_):
        if not type_.is_array:
            return self.one(type_)
        fixed = type_.array_size is not None and not type_.is_upper_bound
        return [self.one(type_) for _ in range(type_.array_size if fixed else self.number('I'))]

    def one(self, type_):
        if type_.pkg_name:
            return self.struct(f'{type_.pkg_name}/{type_.type}')
        if type_.type == 'string':
            size = self.number('I')
            self.at += size
            return self.body[self.at - size:self.at - 1].decode()
        return self.number(FORMATS[type_.type])

    def number(self, form):
        size = struct.calcsize(form)
        self.at += -self.at % size
        value, = struct.unpack_from('<' + form, self.body, self.at)
        self.at += size
        return value


def main():
    with open(sys.argv[1], 'rb') as opened:
        file = opened.read()
    assert file.startswith(MAGIC) and file.endswith(MAGIC)
    data = Data(file)
    check_summary(file, data)
    result = {'profile': data.profile, 'topics': {}, 'messages': []}
    decoders = {}
    for number, channel in data.channels.items():
        schema = data.schemas[channel['schema']]
        assert schema['encoding'] == 'ros2msg' and channel['encoding'] == 'cdr'
        result['topics'][channel['topic']] = {'type': schema['name'], **channel['metadata']}
        decoders[number] = Cdr(schema['name'], schema['text'])
    for message in data.messages:
        message['value'] = decoders[message.pop('channel')].decode(message.pop('cdr'))
        result['messages'].append(message)
    print(json.dumps(result))


if __name__ == '__main__':
    main()
