#include "check.h"

#include "io/xml.h"

static pel_xml_tag tag_of(const char *text)
{
    pel_xml_tag tag;
    assert_true(pel_xml_next(&text, text + strlen(text), &tag));
    return tag;
}

static void check_tags(const char *text, const char *const *tags, size_t count)
{
    const char *at = text, *end = text + strlen(text);
    pel_xml_tag tag;
    for (size_t i = 0; i < count; i++) {
        assert_true(pel_xml_next(&at, end, &tag));
        assert_int_equal(tag.end - tag.start, strlen(tags[i]));
        assert_memory_equal(tag.start, tags[i], strlen(tags[i]));
    }
    assert_false(pel_xml_next(&at, end, &tag));
}

static void test_tags(void **unused)
{
    (void)unused;
    const char *text = "<?xml?>words<Piece a=\"<>\"><b c='\">'/></Piece><open";
    static const char *const tags[] = {"?xml?", "Piece a=\"<>\"", "b c='\">'/", "/Piece"};
    check_tags(text, tags, sizeof tags / sizeof *tags);
}

/* a comment ends at the first --> after its start, for any content */
static void test_comments(void **unused)
{
    (void)unused;
    static const char *const tags[] = {"!----", "!-- <a> > ' --", "!-->--", "!--->--", "a"};
    const char *text = "<!----><!-- <a> > ' --><!-->--><!--->--><a><!-- open ->";
    check_tags(text, tags, sizeof tags / sizeof *tags);
}

static void test_names(void **unused)
{
    (void)unused;
    pel_xml_tag tag = tag_of("<Points a='1'>"), closed = tag_of("<Points/>"), longer = tag_of("<PointsData>");
    assert_true(pel_xml_is(&tag, "Points"));
    assert_true(pel_xml_is(&closed, "Points"));
    assert_false(pel_xml_is(&longer, "Points"));
    assert_false(pel_xml_is(&tag, "PointsData"));
}

static void test_attributes(void **unused)
{
    (void)unused;
    pel_xml_tag tag =
        tag_of("<Array Name = \"a &lt;&amp;&gt; &quot;b&apos; &x;\"\n names='other' empty='' file=\"12\">");
    char text[32];
    assert_true(pel_xml_attribute(&tag, "Name", text, sizeof text));
    assert_string_equal(text, "a <&> \"b' &x;");
    assert_true(pel_xml_attribute(&tag, "names", text, sizeof text));
    assert_string_equal(text, "other");
    assert_true(pel_xml_attribute(&tag, "empty", text, sizeof text));
    assert_string_equal(text, "");
    /* a value and its terminating zero just fit, or not */
    assert_true(pel_xml_attribute(&tag, "file", text, 3));
    assert_string_equal(text, "12");
    assert_false(pel_xml_attribute(&tag, "file", text, 2));
    assert_string_equal(text, "");
    assert_false(pel_xml_attribute(&tag, "name", text, sizeof text));
    assert_false(pel_xml_attribute(&tag, "Array", text, sizeof text));
    pel_xml_tag bad = tag_of("<a b=unquoted c=\"1\">");
    assert_false(pel_xml_attribute(&bad, "b", text, sizeof text));
}

static void test_counts(void **unused)
{
    (void)unused;
    pel_xml_tag tag =
        tag_of("<a n='42' none='' word='4x' minus='-1' space=' 4\t\n' two='4 2' blank=' ' most='999999999999999999' "
               "more='1000000000000000000' real='1.5'/>");
    int64_t count = 7;
    assert_true(pel_xml_count(&tag, "n", &count));
    assert_int_equal(count, 42);
    assert_true(pel_xml_count(&tag, "most", &count));
    assert_int_equal(count, 999999999999999999);
    assert_true(pel_xml_count(&tag, "space", &count));
    assert_int_equal(count, 4);
    static const char *const wrong[] = {"none", "word", "minus", "two", "blank", "more", "real", "absent"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_false(pel_xml_count(&tag, wrong[i], &count));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tags),       cmocka_unit_test(test_comments), cmocka_unit_test(test_names),
        cmocka_unit_test(test_attributes), cmocka_unit_test(test_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
