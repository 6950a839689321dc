#include "rilievo/serve/http/access.h"

#include <gtest/gtest.h>

#include <string>

namespace rilievo {
namespace {

constexpr char kToken[] = "0123456789abcdef";

bool opens(const AccessRules& rules, std::string_view host, std::optional<std::string_view> origin,
           std::string_view target = "/live") {
  return answers_to(rules, host) &&
         may_connect(rules, {.host = host, .origin = origin, .target = target});
}

TEST(Access, HostsAreReadOrRefused) {
  EXPECT_EQ(parse_host("Walk.Example:8080")->name, "walk.example");
  EXPECT_EQ(parse_host("walk.example:8080")->port, 8080);
  EXPECT_EQ(parse_host("[::1]:80")->name, "[::1]");
  EXPECT_EQ(parse_host("[::1]")->port, 0);
  for (const char* damaged :
       {"", ":80", "a:", "a:0", "a:65536", "a:80x", "a b", "a/b", "a@b", "[::1", "[]", "[::1]80",
        "[::1]:", "a:80:80", "a\r\nb", "a:-1", "a:+1"})
    EXPECT_FALSE(parse_host(damaged)) << damaged;
  EXPECT_FALSE(parse_host(std::string(300, 'a')));
}

TEST(Access, OnlyAddressesAndNamesOfThisMachineAreItsOwn) {
  for (const char* name : {"localhost", "127.0.0.1", "127.1.2.3", "[::1]"})
    EXPECT_TRUE(is_this_machine(name)) << name;
  for (const char* name : {"127.0.0.1.evil.example", "127.evil.example", "127.0.0.", "127.0.0",
                           "127..0.1", "localhost.evil.example", "128.0.0.1", "127.0.0.1000", ""})
    EXPECT_FALSE(is_this_machine(name)) << name;
}

TEST(Access, APageOfAnotherOriginIsRefused) {
  const AccessRules open;
  EXPECT_TRUE(opens(open, "127.0.0.1:8080", "http://127.0.0.1:8080"));
  EXPECT_TRUE(opens(open, "localhost:8080", "http://localhost:8080"));
  EXPECT_TRUE(opens(open, "localhost:8080", {}));
  for (const char* origin :
       {"http://evil.example", "http://localhost:3000", "http://127.0.0.1:8080", "null", "",
        "file://", "http://localhost:8080.evil.example", "http://localhost:8080@evil.example",
        "http://localhost:8080/", "localhost:8080"})
    EXPECT_FALSE(opens(open, "localhost:8080", origin)) << origin;
}

TEST(Access, ANameThatWasMadeToLeadHereIsRefusedWithoutAToken) {
  EXPECT_FALSE(opens({}, "evil.example:8080", "http://evil.example:8080"));
  EXPECT_TRUE(opens({.token = kToken, .origins = {}}, "walk.example:8080",
                    "http://walk.example:8080", "/live?token=0123456789abcdef"));
}

TEST(Access, AnOriginThatIsToldIsLetIn) {
  const AccessRules rules{.token = {}, .origins = {"https://walk.example"}};
  EXPECT_TRUE(opens(rules, "walk.example", "https://walk.example"));
  EXPECT_TRUE(opens(rules, "127.0.0.1:8080", "https://walk.example"));
  EXPECT_FALSE(opens(rules, "walk.example:8443", "https://walk.example:8443"));
  // TLS is part of it.
  EXPECT_FALSE(opens(rules, "127.0.0.1:8080", "http://walk.example"));
  EXPECT_FALSE(opens(rules, "walk.example", "http://walk.example"));
  // Under its own name it is as before.
  EXPECT_TRUE(opens(rules, "127.0.0.1:8080", "http://127.0.0.1:8080"));
}

TEST(Access, TheTokenIsAskedFor) {
  const AccessRules rules{.token = kToken, .origins = {}};
  const std::string good = "/live?token=" + std::string(kToken);
  EXPECT_TRUE(opens(rules, "10.0.0.1", {}, good));
  EXPECT_TRUE(opens(rules, "10.0.0.1", {}, "/live?a=b&token=" + std::string(kToken)));
  for (const std::string& target :
       {std::string("/live"), std::string("/live?"), std::string("/live?token="),
        std::string("/live?token=0123456789abcdeF"), good + "0", good.substr(0, good.size() - 1),
        "/live?xtoken=" + std::string(kToken), "/live?token=x&token=" + std::string(kToken)})
    EXPECT_FALSE(opens(rules, "10.0.0.1", {}, target)) << target;
  EXPECT_FALSE(opens(rules, "10.0.0.1", "http://evil.example", good));
}

TEST(Access, WeakTokensAndDamagedOriginsAreRefused) {
  EXPECT_TRUE(check_token(kToken));
  EXPECT_FALSE(check_token("short"));
  EXPECT_FALSE(check_token("0123456789abcde&"));
  EXPECT_FALSE(check_token(std::string(257, 'a')));
  EXPECT_TRUE(check_origin("https://walk.example:8443"));
  for (const char* damaged : {"walk.example", "ws://walk.example", "https://walk.example/walk", ""})
    EXPECT_FALSE(check_origin(damaged)) << damaged;
}

}  // namespace
}  // namespace rilievo
