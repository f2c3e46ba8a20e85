// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/file.hpp>
#include <segue/web/browser_session.hpp>
#include <segue/web/test_support.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace segue::web {

/// A robot with files in the folder `home_`, and a browser that asks for them.
class RobotFilesTest : public WebTest {
 protected:
  explicit RobotFilesTest(ModelsOf models, RunMission run = {})
      : link_([this] { return connection()(); }),
        hub_(link_),
        verbs_(link_, std::move(models), std::move(run)) {}

  void SetUp() override {
    WebTest::SetUp();
    home_ = folder_ / "home";
    std::filesystem::create_directories(home_);
    robot_.show(type::Value::map({{"robot", "fake"}, {"file", (home_ / "robot.yaml").string()}}));
  }
  void write(const std::filesystem::path& path, std::string_view text) const {
    ASSERT_TRUE(write_file(home_ / path, text));
  }
  [[nodiscard]] std::string content(const std::filesystem::path& path) const {
    return read_file(home_ / path).value_or("");
  }

  type::Value ask(const std::string& verb, const type::Value& arguments, Role role = Role::Operate) {
    const auto session = Session::create(hub_, verbs_, {role, "fake", "somebody"}, [] {});
    session->next();
    session->receive(
        type::to_json(type::Value::map({{"id", 1}, {"verb", verb}, {"arguments", arguments}}), -1));
    std::optional<std::string> text;
    EXPECT_TRUE(eventually([&] { return (text = session->next()).has_value(); })) << verb;
    return text ? type::parse_json(*text).value() : type::Value();
  }
  type::Value result(const std::string& verb, const type::Value& arguments, Role role = Role::Operate) {
    const type::Value answer = ask(verb, arguments, role);
    const type::Value* found = answer.find("result");
    EXPECT_NE(found, nullptr) << type::to_json(answer, -1);
    return found != nullptr ? *found : type::Value();
  }
  std::string error(const std::string& verb, const type::Value& arguments, Role role = Role::Operate) {
    const type::Value answer = ask(verb, arguments, role);
    const type::Value* found = answer.find("error");
    return found != nullptr ? found->find("code")->as_string() : "";
  }

  std::filesystem::path home_;
  RobotLink link_;
  Hub hub_;
  Verbs verbs_;
};

}  // namespace segue::web
