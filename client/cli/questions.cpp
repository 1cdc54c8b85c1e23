// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// models, load, unload, status: one call of the server each.
#include <cstdio>
#include <memory>

#include "client/cli/commands.hpp"

namespace bpa::cli {
namespace {

void print(const KnownModel& model) {
  const auto size = [&model](std::size_t i) {
    return 1000 * (model.box_max[i] - model.box_min[i]);
  };
  std::printf("%5d  %-28s %4.0f x %.0f x %.0f mm  %6d points", model.number, model.name.c_str(),
              size(0), size(1), size(2), model.point_count);
  if (model.discrete_symmetries > 0) std::printf("  %d symmetries", model.discrete_symmetries);
  if (model.continuous_symmetries > 0) std::printf("  round");
  std::printf("\n");
}

void print(const ServerStatus& s) {
  std::printf("bpa-server %s, %s, up for %.0f s, %.0f MB\n", s.version.c_str(), s.state.c_str(),
              s.uptime_s, 1e-6 * static_cast<double>(s.memory_bytes));
  std::printf("library   %s, %d models\n", s.library.c_str(), s.model_count);
  const auto count = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  std::printf("frames    %llu received, %llu searched, %llu dropped, %llu rejected\n",
              count(s.frames_received), count(s.frames_processed), count(s.frames_dropped),
              count(s.frames_rejected));
  std::printf("requests  %llu served, %llu refused\n", count(s.requests_served),
              count(s.requests_refused));
  std::printf("queue     %d of %d\n", s.queue_length, s.queue_capacity);
  for (const StageTime& time : s.stage_times) {
    std::printf("  %-28s %8.1f ms (median)\n", time.stage.c_str(), time.milliseconds);
  }
  for (const auto& [key, value] : s.details) {
    std::printf("  %-38s %s\n", key.c_str(), value.c_str());
  }
}

}  // namespace

void add_questions(CLI::App& program, const Common& common) {
  program.add_subcommand("models", "list the models that the server looks for")
      ->callback([&common] {
        const std::vector<KnownModel> models = or_throw(common.connect().models());
        for (const KnownModel& model : models) print(model);
        std::printf("%zu models\n", models.size());
      });

  const auto source = std::make_shared<std::string>(), name = std::make_shared<std::string>();
  CLI::App* load = program.add_subcommand("load", "have the server look for a model as well");
  load->add_option("source", *source, "name in the server's library")->required();
  load->add_option("--name", *name, "name that it gets; default its own");
  load->callback([=, &common] { or_throw(common.connect().load_model(*source, *name)); });

  CLI::App* unload = program.add_subcommand("unload", "have the server forget a model");
  unload->add_option("name", *name, "name of the model")->required();
  unload->callback([=, &common] { or_throw(common.connect().unload_model(*name)); });

  program
      .add_subcommand("status",
                      "how the server is doing; with --timeout S, waits until it is there")
      ->callback([&common] { print(or_throw(common.connect().status())); });
}

}  // namespace bpa::cli
