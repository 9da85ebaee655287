// Text into a document: syntax, positions, limits, --set, and what the hash sees.
#include <gtest/gtest.h>

#include "scene/overrides.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

std::string syntax_error(std::string_view text, const DocumentLimits& limits = {}) {
  try {
    ProblemList problems;
    parse_document(text, "s.json", problems, limits);
    problems.throw_if_any();
    return "";
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::bad_data);
    return e.what();
  }
}

TEST(Document, SaysWhereAndWhatIsWrong) {
  const std::pair<std::string_view, std::string_view> cases[] = {
      {"", "s.json:1:1: the file holds no scene"},
      {"{\n  \"a\": [1,\n", "s.json:3:1: the text ends where the '[' of line 2 is not closed yet"},
      {"{\n \"a\": 1,\n}", "s.json:3:1: a comma before the closing bracket"},
      {"[1, ]", "s.json:1:5: a comma before the closing bracket"},
      {"[1 2]", "s.json:1:4: expected ',' or ']'"},
      {"[12\"x\"]", "s.json:1:4: expected ',' or ']'"},
      {"{\"a\" : 1 \"b\": 2}", "s.json:1:10: expected ',' or '}'"},
      {"{\"a\" 1}", "s.json:1:6: expected ':' behind the key"},
      {"{1: 2}", "s.json:1:2: expected a key in double quotes"},
      {"{\"a\": ]", "s.json:1:7: expected a value"},
      {"{a: 1}", "s.json:1:2: neither a value nor a key; strings stand in double quotes"},
      {"{\"a\": tru}", "s.json:1:7: neither a value nor a key; strings stand in double quotes"},
      {"{\"a\": -}", "s.json:1:7: malformed number"},
      {"{\"a\": 1e999}", "s.json:1:7: the number is too large"},
      {"{\"a\": \"x\ny\"}", "s.json:1:7: the string is not closed on its line"},
      {"\"abc", "s.json:1:1: the string is not closed"},
      {"{\"ä\": \"\\q\"}", "s.json:1:9: unknown escape: \\ is followed by one of \" \\ / b f n r t u"},
      {"{\"a\": \"\xff\"}", "s.json:1:8: the string is not UTF-8"},
      {"{} 5", "s.json:1:4: text behind the end of the scene"},
      {"{ /* x", "s.json:1:3: the comment is not closed"},
      {"{ / x", "s.json:1:3: a comment begins with // or /*"},
      {std::string_view("{}\0", 3), "s.json: the file holds zero bytes: it is no text"},
  };
  for (const auto& [text, error] : cases) EXPECT_EQ(syntax_error(text), error) << text;
}

TEST(Document, EveryValueAndKeyKnowsItsPlace) {
  ProblemList problems;
  const Document d =
      parse_document("\xEF\xBB\xBF{ // ü /* not a comment\n\t\"ä\" : /* 1 */ [12,-3, true] ,\r\n\"b\":{}}", "s.json", problems);
  const JsonMember &a = (*d.root.object())[0], &b = (*d.root.object())[1];
  const auto place = [&](TextPosition p) { return to_string(d.where(p)); };
  EXPECT_EQ(place(d.root.at), "s.json:1:1");
  EXPECT_EQ(place(a.key_at), "s.json:2:2");
  EXPECT_EQ(place(a.value.at), "s.json:2:16");
  const JsonValue::Array& elements = *a.value.array();
  EXPECT_EQ(place(elements[0].at), "s.json:2:17");
  EXPECT_EQ(place(elements[1].at), "s.json:2:20");
  EXPECT_EQ(place(elements[2].at), "s.json:2:24");
  EXPECT_EQ(*elements[1].number(), -3);
  EXPECT_EQ(place(b.key_at), "s.json:3:1");
  EXPECT_EQ(place(b.value.at), "s.json:3:5");
}

TEST(Document, FindsEveryDuplicateKey) {
  EXPECT_EQ(syntax_error("{\"a\": 1, \"b\": {\"c\": 1,\n\"c\": 2}, \"a\": 3}"),
            "s.json:2:1: duplicate key \"c\" (also in line 1)\ns.json:2:10: duplicate key \"a\" (also in line 1)");
}

TEST(Document, KeepsToItsLimits) {
  DocumentLimits limits;
  const std::string deep = std::string(limits.depth, '[') + std::string(limits.depth, ']');
  EXPECT_EQ(syntax_error(deep), "");
  EXPECT_EQ(syntax_error("[" + deep + "]"), "s.json:1:65: more than 64 lists and objects in one another");
  EXPECT_EQ(syntax_error(std::string(10'000'000, '[')), "s.json:1:65: more than 64 lists and objects in one another");
  limits.values = 3;
  EXPECT_EQ(syntax_error("[1, 2]", limits), "");
  EXPECT_EQ(syntax_error("[1, 2, 3]", limits), "s.json:1:8: more than 3 values");
  EXPECT_EQ(syntax_error("{\"a\": {\"b\": 1}}", limits), "s.json:1:8: more than 3 values"); // keys count
  limits.bytes = 4;
  EXPECT_EQ(syntax_error("[1,2]", limits), "s.json: the file is too large for a scene");
}

TEST(Document, HundredProblemsAreEnough) {
  std::string text = "{\"a\":1";
  for (int i = 0; i < 500; ++i) text += ",\"a\":1";
  const std::string errors = syntax_error(text + "}");
  EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 100);
  EXPECT_NE(errors.find("\ns.json:1:602: too many problems; further ones are not shown"), std::string::npos) << errors;
}

std::string canonical(std::string_view text) {
  ProblemList problems;
  return canonical_text(parse_document(text, "s.json", problems).root);
}

TEST(Document, CanonicalTextIsWhatMatters) {
  EXPECT_EQ(canonical("{\"a\":1,\"b\":[true,null]}"), canonical("{ /**/ \"b\" : [true, null], // x\n\"a\": 1.0 }"));
  EXPECT_EQ(canonical("[0.1, -0]"), canonical("[1e-1, 0]"));
  // Pairs that a careless text would confuse.
  EXPECT_NE(canonical("[[1],[2]]"), canonical("[[1,2]]"));
  EXPECT_NE(canonical("[\"1,\"]"), canonical("[1]"));
  EXPECT_NE(canonical("[\"a\",\"b\"]"), canonical("[\"ab\"]"));
  EXPECT_NE(canonical("[12]"), canonical("[1,2]"));
  EXPECT_NE(canonical("[0.1]"), canonical("[0.10000000000000001e-300]"));
  EXPECT_NE(canonical("{\"a\":null}"), canonical("{}"));
}

std::string overridden(std::string_view text, const std::vector<std::string>& assignments) {
  try {
    ProblemList problems;
    Document d = parse_document(text, "s.json", problems);
    apply_overrides(d, assignments, problems);
    problems.throw_if_any();
    return canonical_text(d.root);
  } catch (const Error& e) {
    return e.what();
  }
}

TEST(Overrides, ChangeTheDocument) {
  const std::string_view text = R"({"film": {"spp": 1}, "shapes": [{"name": "drop", "list": [1, 2]}, {"name": "7"}]})";
  const auto expect = [&](const std::string& assignment, std::string_view result) {
    EXPECT_EQ(overridden(text, {assignment}), canonical(result)) << assignment;
  };
  expect("film.spp=4", R"({"film": {"spp": 4}, "shapes": [{"name": "drop", "list": [1, 2]}, {"name": "7"}]})");
  expect("shapes.drop.list.1=[3]", R"({"film": {"spp": 1}, "shapes": [{"name": "drop", "list": [1, [3]]}, {"name": "7"}]})");
  expect("shapes.0.name=dr.op=x", R"({"film": {"spp": 1}, "shapes": [{"name": "dr.op=x", "list": [1, 2]}, {"name": "7"}]})");
  expect("shapes.7={\"a\":true}",
         R"({"film": {"spp": 1}, "shapes": [{"name": "drop", "list": [1, 2]}, {"a": true}]})"); // the name, not the index
  expect("camera.lens.focus=\"2\"",
         R"({"film": {"spp": 1}, "camera": {"lens": {"focus": "2"}}, "shapes": [{"name": "drop", "list": [1, 2]}, {"name": "7"}]})");
  expect("shapes=", R"({"film": {"spp": 1}, "shapes": ""})");
  EXPECT_EQ(overridden(text, {"film.spp=4", "film.spp=5"}), overridden(text, {"film.spp=5"}));
}

TEST(Overrides, SayWhatIsWrong) {
  const std::string_view text = R"({"a": 1, "shapes": [{"name": "drop"}], "list": [1, 2]})";
  const std::pair<std::string, std::string_view> cases[] = {
      {"a", "--set a: expected path=value, such as shapes.drop.threshold=1.1"},
      {"=1", "--set =1: expected path=value, such as shapes.drop.threshold=1.1"},
      {"a.b=1", "--set a.b=1: a is a number: it has no \"b\""},
      {"shapes.dorp.x=1", "--set shapes.dorp.x=1: shapes has no element \"dorp\" (did you mean \"drop\"?)"},
      {"shapes.1.x=1", "--set shapes.1.x=1: shapes has no element 1: there are 1, counted from 0"},
      {"list.-1=1", "--set list.-1=1: list has no element -1: there are 2, counted from 0"},
      {"list=[1,", "--set list=[1,: the text ends where the '[' of line 1 is not closed yet"},
      {"list={\"x\":1,\"x\":2}", "--set list={\"x\":1,\"x\":2}: duplicate key \"x\" (also in line 1)"},
  };
  for (const auto& [assignment, error] : cases) EXPECT_EQ(overridden(text, {assignment}), error);
  // Neither a path nor a value makes the document deeper than its limit.
  std::string path = "a";
  for (int i = 0; i < 70; ++i) path += ".a";
  EXPECT_NE(overridden("{}", {path + "=1"}).find("the path is too long"), std::string::npos);
  EXPECT_NE(overridden("{}", {path.substr(0, 121) + "=[[[[]]]]"}).find("more than 3 lists"), std::string::npos);
}

} // namespace
} // namespace kelpie
