#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/base/vec3.h"
#include "kerf/geometry/shapes.h"

namespace kerf {

enum class YamlKind : uint8_t { null, scalar, sequence, map };

/// A YAML file as plain data; what is shared through an anchor is there once.
struct YamlTree {
  struct Node {
    YamlKind kind = YamlKind::null;
    bool is_quoted = false;         ///< of a scalar
    uint32_t begin = 0, count = 0;  ///< of a scalar: bytes of `text`; of the others: entries of `uses`
  };
  /// A node where it is used, or its alias. Lines and columns count from 1, columns in bytes.
  struct Use {
    uint32_t node = 0, line = 1, column = 1;
  };
  std::string name;  ///< of the file, for places
  std::string text;
  std::vector<Node> nodes;
  std::vector<Use> uses;  ///< of a map: key, value, key, value, ...
  Use root;
};

/// A node of a tree, which must outlive it.
class YamlNode {
 public:
  YamlNode(const YamlTree& tree, const YamlTree::Use& use) : tree_(&tree), use_(use) {}

  YamlKind kind() const { return node().kind; }
  bool is_null() const { return kind() == YamlKind::null; }
  bool is_quoted() const { return node().is_quoted; }

  /// Of a scalar.
  std::string_view text() const { return std::string_view(tree_->text).substr(node().begin, node().count); }
  /// Items of a sequence, pairs of a map; 0 of others.
  size_t size() const;
  YamlNode item(size_t i) const { return {*tree_, tree_->uses[node().begin + i]}; }
  YamlNode key(size_t i) const { return item(2 * i); }
  YamlNode value(size_t i) const { return item(2 * i + 1); }

  uint32_t line() const { return use_.line; }
  /// Whether it stands before the other in the text.
  bool is_before(const YamlNode& other) const;
  /// "room.yaml:12:5"
  std::string place() const;
  /// What it is, as the end of a sentence: "a map", "'red'".
  std::string description() const;
  /// Throws Error (file) with its place.
  [[noreturn]] void fail(const std::string& sentence) const;

 private:
  const YamlTree::Node& node() const { return tree_->nodes[use_.node]; }

  const YamlTree* tree_;
  YamlTree::Use use_;
};

/// What a number may be.
struct YamlRange {
  double least = -kMaxCoordinate, most = kMaxCoordinate;
  bool is_open = false;  ///< the ends themselves are out
};
inline constexpr YamlRange kAnyNumber;
inline constexpr YamlRange kAtLeastZero{0, kMaxCoordinate};
inline constexpr YamlRange kAboveZero{0, kMaxCoordinate, true};
inline constexpr YamlRange kShare{0, 1};

/// The value of a key. What it is read as decides what it must be; anything else is an Error (file) that says what was
/// expected and what was found.
class YamlField {
 public:
  YamlField(const YamlNode& node, std::string_view key) : node_(node), key_(key) {}

  const YamlNode& node() const { return node_; }
  std::string_view key() const { return key_; }
  std::string place() const { return node_.place(); }

  /// Decimal, finite, at most kMaxCoordinate in size, in the range.
  double number(const YamlRange& range = kAnyNumber) const;
  /// number() rounded; one that must be above 0 is so in single precision too.
  float single(const YamlRange& range) const;
  /// A list of exactly three numbers.
  Vec3d vector(const YamlRange& range = kAnyNumber) const;
  Vec3f single_vector(const YamlRange& range = kAnyNumber) const { return to_float(vector(range)); }
  /// true or false, without quotes.
  bool boolean() const;
  /// A scalar of at least one byte, none of them zero, quoted or not.
  std::string text() const;

  /// "KEY: sentence"
  [[noreturn]] void fail(const std::string& sentence) const;
  /// "KEY: expected WHAT, found ..."
  [[noreturn]] void fail_type(std::string_view what) const;

 private:
  YamlNode node_;
  std::string_view key_;
};

/// A map of known keys. `noun` is what it describes, such as "a sphere".
class YamlMap {
 public:
  /// Throws Error (file) if it is no map, or has a key that is no text, a merge key, one that is unknown or there
  /// twice.
  YamlMap(const YamlField& map, std::span<const std::string_view> keys, std::string noun);

  std::optional<YamlField> find(std::string_view key) const;
  /// Throws Error (file) if it is not there.
  YamlField require(std::string_view key) const;
  /// Of two words for the same key; throws Error (file) if both are there.
  std::optional<YamlField> find_either(std::string_view word, std::string_view other) const;
  /// The key itself, which must be there.
  YamlNode key_node(std::string_view key) const;

  const YamlNode& node() const { return node_; }
  const std::string& noun() const { return noun_; }

 private:
  uint32_t pair_of(std::string_view key) const;

  YamlNode node_;
  std::span<const std::string_view> keys_;
  std::string noun_;
  std::vector<uint32_t> pairs_;  // of each known key
};

/// Throws Error (file) at the later one of two keys that must not both be there.
[[noreturn]] void refuse_both(const YamlNode& key, const YamlNode& other, std::string_view reason = {});

/// The value of a key before the other keys can be judged; nothing where it is not there. The first of equal keys.
std::optional<YamlField> peek(const YamlField& map, std::string_view key);

/// The items of a list of maps, which may be empty; the key of each is the list's. Throws Error (file) if it is none.
std::vector<YamlField> items_of(const YamlField& list);

}  // namespace kerf
