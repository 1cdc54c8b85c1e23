// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <iostream>
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

struct LoadCommand {
  std::string source;
  std::string name;
};

}  // namespace

void add_models(CLI::App& program, Common& common) {
  program.add_subcommand("models", "list the models that the server looks for")
      ->callback([&common] {
        common.run([](Client client) -> Status {
          const auto models = client.models();
          if (!models.ok()) return models.status();
          for (const KnownModel& model : *models) print(model);
          std::printf("%zu models\n", models->size());
          return {};
        });
      });

  auto load = std::make_shared<LoadCommand>();
  CLI::App* loader = program.add_subcommand("load", "have the server look for a model as well");
  loader->add_option("source", load->source, "name in the server's library")->required();
  loader->add_option("--name", load->name, "name that it gets; default its own");
  loader->callback([load, &common] {
    common.run([&](Client client) { return client.load_model(load->source, load->name); });
  });

  auto unload = std::make_shared<LoadCommand>();
  CLI::App* unloader = program.add_subcommand("unload", "have the server forget a model");
  unloader->add_option("name", unload->name, "name of the model")->required();
  unloader->callback([unload, &common] {
    common.run([&](Client client) { return client.unload_model(unload->name); });
  });
}

}  // namespace bpa::cli
