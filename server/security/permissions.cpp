// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/security/permissions.hpp"

#include "core/base/failure.hpp"
#include "idl/wire/names.hpp"

namespace bpa::server {
namespace {

/// DDS names of topics; those whose name is empty are left out.
class Topics {
 public:
  explicit Topics(const ServerOptions& options)
      : node_{options.node.ros_namespace, options.node.name} {
    for (const std::string& text : options.node.remaps) {
      remaps_.push_back(or_throw(wire::parse_remap(text)));
    }
  }
  Topics& add(const std::string& name) {
    if (!name.empty()) names_.push_back(wire::dds_topic_name(full(name)));
    return *this;
  }
  /// An image topic, raw and as image_transport names it.
  Topics& add_image(const std::string& name) {
    if (name.empty()) return *this;
    const std::string base = full(name);
    for (const char* transport : {"", "/compressed", "/compressedDepth"}) {
      names_.push_back(wire::dds_topic_name(base + transport));
    }
    return *this;
  }
  /// Everything below a name.
  Topics& add_below(const std::string& name) {
    names_.push_back(wire::dds_topic_name(full(name)) + "/*");
    return *this;
  }
  const std::vector<std::string>& names() const { return names_; }
  /// "/bpa/*": the name of any service below the server's namespace.
  std::string services() const {
    return node_.node_namespace == "/" ? "/*" : node_.node_namespace + "/*";
  }

 private:
  std::string full(const std::string& name) const {
    return or_throw(wire::resolve_name(name, node_, remaps_));
  }

  const wire::NodeName node_;
  std::vector<wire::Remap> remaps_;
  std::vector<std::string> names_;
};

std::vector<std::string> joined(std::vector<std::string> names,
                                const std::vector<std::string>& more) {
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

}  // namespace

std::vector<Permissions> default_permissions(const ServerOptions& options) {
  const InputOptions& in = options.input;
  Topics inputs(options);
  inputs.add(in.frames).add_image(in.color).add_image(in.depth).add(in.camera_info).add(in.cloud);
  inputs.add(in.tf).add(in.tf_static).add("/clock");

  const OutputOptions& out = options.output;
  Topics outputs(options);
  outputs.add(out.interpretations).add(out.detections).add(out.annotated).add(out.markers);
  outputs.add(out.vision_info).add(out.tf).add(out.tracks).add(out.track_states);
  outputs.add(out.track_markers).add(out.diagnostics).add(out.rosout).add("/parameter_events");
  if (!options.capture.source.empty()) {
    const CaptureOptions& capture = options.capture;
    outputs.add(capture.color_topic).add(capture.color_info_topic).add(capture.depth_topic);
    outputs.add(capture.depth_info_topic).add(capture.points_topic);
  }

  // Fronts and workers: servers alone may take part in a group.
  Topics group(options);
  group.add_below("group/" + options.group.name);

  const std::vector<std::string> graph = {"ros_discovery_info"};
  const std::vector<std::string> requests = {wire::dds_request_topic_name(inputs.services())};
  const std::vector<std::string> replies = {wire::dds_reply_topic_name(inputs.services())};
  const auto readable = joined(joined(graph, inputs.names()), outputs.names());
  const auto members = joined(joined(group.names(), requests), replies);
  return {{"/bpa_server", joined(joined(graph, outputs.names()), members),
           joined(joined(graph, inputs.names()), members)},
          {"/robot", joined(joined(graph, inputs.names()), requests), joined(readable, replies)},
          {"/viewer", graph, readable}};
}

}  // namespace bpa::server
