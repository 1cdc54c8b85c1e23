// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa simulate sequence: frames of a moving camera, objects and arm, written as BOP scenes.
#include <algorithm>
#include <cstdio>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/sim/sequence.hpp"
#include "tools/mesh_input.hpp"
#include "tools/simulated_objects.hpp"

namespace bpa::cli {
namespace {

// Of the first frame of the first sequence; those after it follow 1000 s apart.
constexpr std::int64_t kFirstStamp = 1'700'000'000'000'000'000, kStampsApart = 1'000'000'000'000;

struct SequenceArguments {
  CommonOptions common;
  std::string out, split = "test";
  ObjectChoice objects;
  int sequences = 1;
  std::string handle;
  bool masks = false;
  sim::SequenceOptions options;
};

void print_sequence(int scene_id, const sim::Sequence& sequence, const sim::Stage& stage) {
  const auto dropped = std::ranges::count(sequence.frames, true, &sim::SequenceFrame::dropped);
  std::printf("scene %d: %s, %zu objects, %zu frames, %d of them dropped\n", scene_id,
              std::string(name_of(sequence.kind)).c_str(), sequence.objects.size(),
              sequence.frames.size(), static_cast<int>(dropped));
  for (const sim::SequenceEvent& event : sequence.events) {
    const int object = sequence.objects[event.instance];
    std::printf("  %6.2f to %6.2f s  %-8s  instance %d, %s\n", event.start, event.end,
                std::string(name_of(event.kind)).c_str(), event.instance + 1,
                stage.objects()[object].name.c_str());
  }
}

void write_sequence(const SequenceArguments& a, const sim::Stage& stage,
                    const sim::Sequence& sequence, int index) {
  io::BopSceneWriter writer(a.out, a.split, index + 1, kDepthUnitMm,
                            a.masks ? io::BopMasks::written : io::BopMasks::counted);
  const int frames = static_cast<int>(sequence.frames.size());
  run_all("frames", frames, a.common.threads, [&](int i) {
    if (sequence.frames[i].dropped) return;
    sim::SimulatedFrame frame = sim::capture_frame(stage, sequence, i);
    frame.frame.stamp_ns += kFirstStamp + index * kStampsApart;
    std::vector<io::BopInstanceRecord> records = records_of(frame);
    for (std::size_t k = 0; k < records.size(); ++k) {
      records[k].instance = static_cast<int>(k) + 1;
    }
    or_throw(writer.add(i, frame.frame, records, frame.camera_from_world));
  });
  or_throw(writer.finish());
}

/// Makes what stands out of one object its telltale.
void find_handle(const std::string& name, std::vector<sim::SimulatedObject>& objects) {
  const auto object = std::ranges::find(objects, name, &sim::SimulatedObject::name);
  if (object == objects.end()) throw Failure(not_found("--handle: there is no object " + name));
  object->telltales = sim::protruding_vertices(object->mesh);
  if (object->telltales.empty()) {
    throw Failure(invalid_argument("--handle: nothing stands out of the wall of " + name));
  }
}

void simulate_sequences(const SequenceArguments& a) {
  std::vector<sim::SimulatedObject> objects = chosen_objects(a.objects, a.common.threads);
  if (!a.handle.empty()) find_handle(a.handle, objects);
  write_models(a.out, objects);
  const sim::Stage stage = sim::sequence_stage(std::move(objects), a.common.threads);
  for (int i = 0; i < a.sequences; ++i) {
    const sim::Sequence sequence =
        or_throw(sim::plan_sequence(stage, a.options, sim::scene_seed(a.common.seed, i)));
    print_sequence(i + 1, sequence, stage);
    std::fflush(stdout);
    write_sequence(a, stage, sequence, i);
  }
}

void add_kind_option(CLI::App& command, sim::SequenceKind& kind) {
  std::vector<std::string> names;
  for (const sim::SequenceKind one : sim::kSequenceKinds) names.emplace_back(name_of(one));
  const auto set = [&kind](const std::string& name) {
    kind = sim::sequence_kind(name).value_or(sim::SequenceKind::mixed);
  };
  command
      .add_option_function<std::string>(
          "--kind", set,
          "What happens, mixed if not given. mixed: pushes, picks and occlusions in turn; twins "
          "pass "
          "in a third of the sequences. standing: nothing moves. moving_camera: only the camera. "
          "In the others it moves too: a fist pushes objects, a hand picks and places them, an arm "
          "passes before them, two objects of one model pass each other, or the first object is "
          "turned until its hidden handle is in sight")
      ->check(CLI::IsMember(names));
}

}  // namespace

void add_sequence_command(CLI::App& simulate) {
  const auto [command, a] =
      add_command(simulate, "sequence", "Frames of a moving camera, objects and a person's arm",
                  simulate_sequences);
  add_option(command, "--out", a.out, "Folder of the data set to write", "DIR")->required();
  add_split_option(command, a.split);
  add_unit_options(command, a.objects.scale);
  add_object_options(command, a.objects);
  add_option(command, "--sequences", a.sequences, "Number of sequences, a BOP scene each")
      ->check(CLI::Range(1, 9999));
  add_kind_option(command, a.options.kind);
  add_option(command, "--handle", a.handle,
             "The mesh of --meshes whose handle --kind handle hides at first, such as 025_mug",
             "NAME");
  add_range_option(command, "--objects", a.options.min_objects, a.options.max_objects,
                   "Fewest and most objects of a sequence; 8,8 if not given");
  add_range_option(command, "--distance", a.options.min_distance, a.options.max_distance,
                   "Range from the camera to the middle, metres; 0.7,1.1 if not given");
  add_sensor_option(command, a.options.sensor, a.options.mixed_sensors, "sequence");
  command.add_flag("--masks", a.masks, "Also write the masks of the visible pixels");
  add_options(command, options_of(a.options),
              {{"--seconds", "seconds"},
               {"--rate", "rate"},
               {"--drop", "drop"},
               {"--distractors", "max_distractors"},
               {"--camera-speed", "camera_speed"},
               {"--camera-turn-deg", "camera_turn_deg"},
               {"--object-speed", "object_speed"},
               {"--object-turn-deg", "object_turn_deg"},
               {"--max-occlusion", "max_occlusion"}});
}

}  // namespace bpa::cli
