// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/yaml_text.hpp"

#include <sstream>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

namespace bpa::io {
namespace {

class AliasRefusal : public YAML::EventHandler {
  using Style = YAML::EmitterStyle::value;
  using Anchor = YAML::anchor_t;

  void OnAlias(const YAML::Mark& mark, Anchor) override {
    throw YAML::ParserException(mark, "aliases (*name) are not read");
  }
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, Anchor) override {}
  void OnScalar(const YAML::Mark&, const std::string&, Anchor, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, Anchor, Style) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, Anchor, Style) override {}
  void OnMapEnd() override {}
};

}  // namespace

YAML::Node parse_yaml(const std::string& text) {
  std::istringstream stream(text);
  AliasRefusal refusal;
  YAML::Parser(stream).HandleNextDocument(refusal);
  return YAML::Load(text);
}

}  // namespace bpa::io
