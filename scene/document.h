// A scene file as text says it: JSON values, each with its place, before anyone asks what they mean.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "scene/problem_list.h"

namespace kelpie {

/// Where a value or key stands: line and column from 1 (a column is a Unicode code point), in one of the document's
/// sources. What comes from the command line has no lines.
struct TextPosition {
  std::uint32_t line = 0, column = 0, source = 0;
};

struct JsonMember;

/// A JSON value. All numbers are double; an integer beyond 2^53 is rounded.
struct JsonValue {
  using Array = std::vector<JsonValue>;
  using Object = std::vector<JsonMember>;

  std::variant<std::nullptr_t, bool, double, std::string, Array, Object> data;
  TextPosition at;

  const bool* boolean() const { return std::get_if<bool>(&data); }
  const double* number() const { return std::get_if<double>(&data); }
  const std::string* string() const { return std::get_if<std::string>(&data); }
  const Array* array() const { return std::get_if<Array>(&data); }
  const Object* object() const { return std::get_if<Object>(&data); }
  /// The member of an object; null where there is none, or this is no object.
  const JsonValue* find(std::string_view key) const;
};

/// Members keep the order of the text.
struct JsonMember {
  std::string key;
  TextPosition key_at;
  JsonValue value;
};

/// "a number", "a string", "an object"…: what an error says was found.
std::string_view describe(const JsonValue&);

/// The text in quotes as an error message may show it: shortened, without control characters.
std::string in_quotes(std::string_view);

/// JSON in one line, the same for any two texts that differ only in white space, comments, order of keys and spelling of
/// numbers: what the scene's hash is made of.
std::string canonical_text(const JsonValue&);

/// What a file may demand of the machine.
struct DocumentLimits {
  size_t bytes = size_t{1} << 30;
  size_t values = 10'000'000; ///< keys count as well
  size_t depth = 64;          ///< of arrays and objects in one another
};

/// A text that a document is made of.
struct DocumentSource {
  std::string name;               ///< what errors call it: the file as it was named, or `--set …`
  std::filesystem::path folder{}; ///< that the files it names are relative to, itself relative to the scene's folder
  bool is_command_line = false;
};

struct Document {
  JsonValue root;
  std::vector<DocumentSource> sources; ///< the scene file, then whatever was included or set
  size_t bytes = 0, values = 0;        ///< of all files
  bool is_complete = true;             ///< false where something could not be included: names may be missing

  SourcePosition where(TextPosition) const;
};

/// Parses JSON with comments. Throws an Error with the position of a fault in syntax; duplicate keys go
/// to `problems`. `file` is only a name here.
Document parse_document(std::string_view text, std::string file, ProblemList& problems, const DocumentLimits& = {});

/// Reads and parses the file. Throws Error missing_input where it cannot be read.
Document read_document(const std::string& path, ProblemList& problems, const DocumentLimits& = {});

/// The same for a further source of a document: returns its root. The limits are for all files together.
JsonValue parse_source(std::string_view text, std::uint32_t source, Document&, ProblemList& problems, const DocumentLimits&);
JsonValue read_source(const std::string& path, std::uint32_t source, Document&, ProblemList& problems, const DocumentLimits&);

} // namespace kelpie
