// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <memory>
#include <vector>

#include "client/cli/commands.hpp"
#include "client/cli/convert.hpp"
#include "client/cli/options.hpp"
#include "client/cli/output.hpp"

namespace bpa::cli {
namespace {

struct DetectCommand {
  FrameFiles files;
  DetectQuery query;
  std::string priors;
  std::string json;
  int top = 5;
  double wait_s = 60;
};

void detect(Client client, DetectCommand& command) {
  command.query.priors = read_priors(command.priors);
  const std::chrono::milliseconds wait(static_cast<long>(1000 * command.wait_s));
  std::vector<DetectionSet> sets;
  const auto report = [&](const Result<DetectionSet>& found) {
    sets.push_back(or_throw(found));
    print_detections(sets.back(), command.top);
  };
  if (command.files.empty()) {
    report(client.detect(command.query, wait));
  } else {
    for (const io::BopFrame& entry : list_frames(command.files)) {
      if (interrupted()) throw Failure({StatusCode::unavailable, "interrupted"});
      const Frame frame = load_frame(entry, command.files, 0);
      report(client.detect_in(view_of(frame), command.query, wait));
    }
  }
  write_results(command.json, sets);
}

}  // namespace

void add_detect(CLI::App& program, const Common& common) {
  CLI::App* sub = program.add_subcommand(
      "detect",
      "ask for one search: of frames from disk, or of the next one of the server's camera");
  auto command = std::make_shared<DetectCommand>();
  add_frame_options(*sub, command->files);
  sub->add_option("--models", command->query.models, "names of models; default all")
      ->delimiter(',');
  sub->add_option("--top-k", command->query.top_k, "interpretations wanted; default the server's")
      ->check(CLI::Range(1, 100));
  sub->add_option("--budget-ms", command->query.budget_ms, "report the best so far after this long")
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--seed", command->query.seed, "same frame and seed: same answer");
  add_priors_option(*sub, command->priors);
  sub->add_option("--json", command->json, "write all results to this file");
  sub->add_option("--top", command->top, "interpretations to print")->capture_default_str();
  sub->add_option("--wait", command->wait_s, "seconds to wait for an answer")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  sub->callback([command, &common] {
    check_frame_options("detect", command->files, false);
    detect(common.connect(), *command);
  });
}

}  // namespace bpa::cli
