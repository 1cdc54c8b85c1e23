// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/private/service_framing.hpp"

#include <algorithm>
#include <cstring>

namespace bpa::wire::detail {
namespace {

constexpr std::size_t kPrefixSize = 12;

bool is_reader(const Guid& guid) {
  const int kind = guid[15] & 0x3f;  // with a key 0x07, without 0x04
  return kind == 0x04 || kind == 0x07;
}

Guid any_entity_of(Guid guid) {
  std::fill(guid.begin() + kPrefixSize, guid.end(), std::uint8_t{0});
  return guid;
}

}  // namespace

Status read_request_frame(const std::vector<std::uint8_t>& bytes, const SampleMeta& meta,
                          ReplyAddress* address, std::size_t* body_offset, bool* swap) {
  if (!read_cdr_header(bytes.data(), bytes.size(), swap)) {
    return Status(StatusCode::corrupt, "not plain CDR");
  }
  address->client = any_entity_of(meta.id.writer);
  if (meta.related.writer != Guid{}) {
    const Guid& client = meta.related.writer;
    address->framing = Framing::fastdds;
    address->related = {client, meta.id.sequence};
    address->reader = is_reader(client) ? client : any_entity_of(client);
    *body_offset = kCdrHeaderSize;
    return {};
  }
  if (bytes.size() < kCdrHeaderSize + kCycloneHeaderSize) {
    return Status(StatusCode::corrupt, "neither a related sample identity nor a request header");
  }
  address->framing = Framing::cyclone;
  address->reader = any_entity_of(meta.id.writer);
  std::memcpy(address->header.data(), bytes.data() + kCdrHeaderSize, kCycloneHeaderSize);
  if (*swap) {  // two integers of 8 bytes; replies are in this host's order
    std::reverse(address->header.begin(), address->header.begin() + 8);
    std::reverse(address->header.begin() + 8, address->header.end());
  }
  *body_offset = kCdrHeaderSize + kCycloneHeaderSize;
  return {};
}

std::vector<std::uint8_t> frame_reply(const ReplyAddress& address, const MessageRef& response) {
  const std::size_t extra = address.framing == Framing::cyclone ? kCycloneHeaderSize : 0;
  const std::size_t size = response.encoded_size(response.message);
  std::vector<std::uint8_t> bytes(extra + size);
  if (response.encode(response.message, bytes.data() + extra, size) == 0) return {};
  if (extra != 0) {  // 16 bytes do not change the alignment of what follows
    std::memcpy(bytes.data(), bytes.data() + extra, kCdrHeaderSize);
    std::memcpy(bytes.data() + kCdrHeaderSize, address.header.data(), extra);
  }
  return bytes;
}

}  // namespace bpa::wire::detail
