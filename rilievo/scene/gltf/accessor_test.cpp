#include "rilievo/scene/gltf/accessor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "rilievo/scene/gltf/gltf_test_helpers.h"

namespace rilievo::gltf {
namespace {

using test::GltfBuilder;

struct Random {
  std::mt19937 rng;
  std::uint32_t below(std::uint32_t n) { return rng() % n; }
};

const int kComponents[] = {5120, 5121, 5122, 5123, 5125, 5126};

std::size_t size_of(int component) { return component <= 5121 ? 1 : component <= 5123 ? 2 : 4; }

// Appends a number of the component's type to `bytes` and returns what it means.
double append_number(Random& random, int component, std::string& bytes) {
  const auto append = [&](auto value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    return double(value);
  };
  switch (component) {
    case 5120:
      return append(std::int8_t(random.rng()));
    case 5121:
      return append(std::uint8_t(random.rng()));
    case 5122:
      return append(std::int16_t(random.rng()));
    case 5123:
      return append(std::uint16_t(random.rng()));
    case 5125:
      return append(std::uint32_t(random.rng()));
    default:
      return append(float(random.rng()) / 1e6f);
  }
}

// glTF 2.0, table 11 (conversion of normalised integers).
double slow_normalized(int component, double c) {
  switch (component) {
    case 5120:
      return std::max(c / 127.0, -1.0);
    case 5121:
      return c / 255.0;
    case 5122:
      return std::max(c / 32767.0, -1.0);
    case 5123:
      return c / 65535.0;
    case 5125:
      return c / 4294967295.0;
    default:
      return c;
  }
}

// An accessor of random type, stride, offsets and sparseness, with the values it stands for.
struct Case {
  std::string file;
  int numbers = 1, component = 5126;
  std::vector<double> values;
};

Case random_case(Random& random) {
  static const char* const kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  Case c;
  c.numbers = 1 + int(random.below(4));
  c.component = kComponents[random.below(6)];
  const bool normalized = c.component != 5126 && random.below(2);
  const std::size_t count = 1 + random.below(20);
  const std::size_t element = size_of(c.component) * c.numbers;
  const std::size_t stride = random.below(2) ? 0 : (element + 3) / 4 * 4 + 4 * random.below(3);
  const std::size_t offset = 4 * random.below(4);
  const bool backed = random.below(4) != 0, sparse = !backed || random.below(2);

  GltfBuilder b;
  b.view(std::string(4 + 4 * random.below(5), 'x'));  // so that the view's own offset matters
  nlohmann::json accessor = {{"componentType", c.component},
                             {"type", kTypes[c.numbers - 1]},
                             {"count", count},
                             {"normalized", normalized}};
  c.values.assign(count * c.numbers, 0.0);
  if (backed) {
    std::string bytes(offset, 'x');
    for (std::size_t i = 0; i < count; ++i) {
      for (int k = 0; k < c.numbers; ++k)
        c.values[i * c.numbers + k] = append_number(random, c.component, bytes);
      if (stride && i + 1 < count) bytes.resize(offset + (i + 1) * stride, 'x');
    }
    accessor["bufferView"] = b.view(bytes, int(stride));
    accessor["byteOffset"] = offset;
  }
  if (sparse) {
    const int index_type = std::array{5121, 5123, 5125}[random.below(3)];
    std::string indices, values;
    std::size_t replaced = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (random.below(3)) continue;
      ++replaced;
      for (std::size_t k = 0; k < size_of(index_type); ++k) indices += k == 0 ? char(i) : '\0';
      for (int k = 0; k < c.numbers; ++k)
        c.values[i * c.numbers + k] = append_number(random, c.component, values);
    }
    accessor["sparse"] = {
        {"count", replaced},
        {"indices", {{"bufferView", b.view(indices)}, {"componentType", index_type}}},
        {"values", {{"bufferView", b.view(values)}}}};
  }
  if (normalized)
    for (double& v : c.values) v = slow_normalized(c.component, v);
  b.accessor(accessor);
  c.file = b.glb();
  return c;
}

TEST(GltfAccessor, reads_every_type_stride_and_sparse_replacement) {
  Random random{std::mt19937(31)};
  for (int round = 0; round < 1000; ++round) {
    const Case c = random_case(random);
    LoadContext context{"", {}, 0.0, MemoryBudget(1 << 20)};
    Document document = open_document(bytes_of(c.file), context);
    const Accessor a = describe_accessor(document, 0);
    ASSERT_EQ(a.numbers, c.numbers);
    const std::vector<float> all = read_floats(document, a);
    ASSERT_EQ(all.size(), c.values.size());
    // A float holds 24 bits: 6e-8 of the value, doubled for the division.
    for (std::size_t i = 0; i < all.size(); ++i)
      ASSERT_NEAR(all[i], c.values[i], 1.2e-7 * std::abs(c.values[i])) << round;

    std::vector<std::uint32_t> listed;
    for (std::uint32_t k = 0; k < 5; ++k) listed.push_back(random.below(std::uint32_t(a.count)));
    const std::vector<float> some = read_floats(document, a, {false, listed});
    ASSERT_EQ(some.size(), 5u * c.numbers);
    for (std::size_t i = 0; i < some.size(); ++i)
      EXPECT_EQ(some[i], all[listed[i / c.numbers] * c.numbers + i % c.numbers]);

    if (c.component == 5121 || c.component == 5123 || c.component == 5125) {
      if (document.root()["accessors"][std::size_t(0)]["normalized"].boolean(false)) continue;
      const std::vector<std::uint32_t> integers = read_integers(document, a);
      for (std::size_t i = 0; i < integers.size(); ++i) EXPECT_EQ(integers[i], c.values[i]);
    }
  }
}

TEST(GltfUri, base64_of_every_length_comes_back) {
  static const char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  Random random{std::mt19937(32)};
  for (std::size_t length = 0; length < 50; ++length) {
    std::string bytes, bits, text;
    for (std::size_t i = 0; i < length; ++i) bytes += char(random.rng());
    for (unsigned char c : bytes)
      for (int k = 7; k >= 0; --k) bits += c >> k & 1 ? '1' : '0';
    while (bits.size() % 6) bits += '0';
    for (std::size_t i = 0; i < bits.size(); i += 6)
      text += kDigits[std::stoi(bits.substr(i, 6), nullptr, 2)];
    while (text.size() % 4) text += '=';
    LoadContext context{"", {}, 0.0, MemoryBudget(1 << 20)};
    EXPECT_EQ(read_uri("data:application/octet-stream;base64," + text, context), bytes);
  }
}

TEST(GltfUri, refuses_what_is_not_beside_the_file) {
  LoadContext context{"", std::filesystem::path("."), 0.0, MemoryBudget(1 << 20)};
  const auto why = [&](const std::string& uri) {
    try {
      return read_uri(uri, context);
    } catch (const LoadError& fault) {
      return fault.reason;
    }
  };
  EXPECT_EQ(why("http://a/b"), "refers to 'http://a/b', which is not a relative path");
  EXPECT_EQ(why("file:///etc/passwd"),
            "refers to 'file:///etc/passwd', which is not a relative path");
  const std::string outside =
      "', which is outside of the scene's folder (--allow-outside reads it)";
  EXPECT_EQ(why("/etc/passwd"), "refers to '/etc/passwd" + outside);
  EXPECT_EQ(why("%2Fetc%2Fpasswd"), "refers to '/etc/passwd" + outside);
  EXPECT_EQ(why("../../../../../../../../etc/passwd"),
            "refers to '../../../../../../../../etc/passwd" + outside);
  EXPECT_EQ(why("a/..%2f%2e./b"), "refers to 'a/../../b" + outside);
  EXPECT_EQ(why("C:\\a"), "refers to the absolute path 'C:\\a' of another system");
  EXPECT_EQ(why("no%20such.bin"), "'no such.bin': No such file or directory");
  EXPECT_EQ(why("data:;base64,A"), "has a data URI whose base64 is cut short");
  EXPECT_EQ(why("data:;base64,A?=="), "has a data URI that is not base64");
}

}  // namespace
}  // namespace rilievo::gltf
