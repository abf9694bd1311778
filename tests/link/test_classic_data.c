/* SPDX-License-Identifier: MIT */
/* Postures, motions and their files on the classic shelf, beside the original: classic_kit.h. */
#include "tests/support/classic_kit.h"

static int set_up(void)
{
    classic_make_files();
    g = GR001_new("sim"); /* it is not connected: its current posture is all 0 */
    assert_non_null(g);
    return 0;
}

static int tear_down(void)
{
    GR001_delete(g);
    classic_remove_files();
    return 0;
}

TESTS_BETWEEN(set_up, tear_down)

static void two_postures(void)
{
    RobotPosture_setDegree(p, 1, 10);
    RobotPosture_setDegree(q, 1, 20);
    assert_true(RobotMotion_appendPosture(m, RobotPosture_dupPosture(p)));
    assert_true(RobotMotion_appendPosture(m, RobotPosture_dupPosture(q)));
}

static void fn01(void)
{
    say(rad2deg(0.2));
    say(rad2deg(-3.2));
}

static void fn02(void)
{
    say(deg2rad(90));
}

static void rp04(void)
{
    RobotPosture z;
    RobotPosture_init(&z, 20);
    say(z.motionTime);
}

static void rp07(void)
{
    RobotPosture_setDegree(p, 4, 33);
    RobotPosture *d = RobotPosture_dupPosture(p);
    RobotPosture_setDegree(p, 4, 0);
    say_posture(d);
    RobotPosture_delete(d);
}

static void rp08(void)
{
    say(RobotPosture_setMotionTime(p, 120));
    say(p->motionTime);
}

static void rp09(void)
{
    RobotPosture_setDegree(p, 3, 155);
    say(RobotPosture_getDegree(p, 3));
    say(p->jointAngles[2]);
    say(RobotPosture_getDegree(p, 0));
    say(RobotPosture_getDegree(p, 21));
}

static void rp10(void)
{
    RobotPosture_setRad(p, 2, 0.5);
    say(RobotPosture_getRad(p, 2));
    say(RobotPosture_getRad(p, 21));
}

static void rp15(void)
{
    RobotPosture_setDegree(p, 5, 50);
    RobotPosture_setDegree(q, 5, 7);
    RobotPosture_copyPosture(q, p);
    say_posture(q);
    say_posture(p);
}

static void rp16(void)
{
    RobotPosture_setDegree(p, 1, 50);
    RobotPosture_setDegree(p, 2, 60);
    RobotPosture_copyPosture_offset(q, p, 3);
    say_posture(q);
}

static void rp17(void)
{
    RobotPosture_setDegree(p, 6, 61);
    say(RobotPosture_getJointAngles(p)[5]);
}

static void rp18(void)
{
    RobotPosture_setDegree(p, 6, 90);
    say(RobotPosture_getJointAnglesRad(p)[5]);
}

static void rp19(void)
{
    say(RobotPosture_equalTo(p, q));
    RobotPosture_setDegree(q, 20, 1);
    say(RobotPosture_equalTo(p, q));
    say(RobotPosture_equalTo(p, NULL));
}

static void rp20(void)
{
    RobotPosture_setDegree(q, 20, 4);
    say(RobotPosture_nearTo(p, q, 5));
    say(RobotPosture_nearTo(p, q, 3));
    say(RobotPosture_nearTo(p, q, 4));
}

static void rm08(void)
{
    two_postures();
    say(RobotMotion_getSize(m));
    say(RobotPosture_getDegree(m->motion[1], 1));
}

static void rm09(void)
{
    two_postures();
    say(RobotMotion_setReverse(m, true));
    say(RobotPosture_getDegree(RobotMotion_next(m), 1));
    say(RobotPosture_getDegree(RobotMotion_next(m), 1));
    say(RobotPosture_getDegree(RobotMotion_next(m), 1));
}

static void rm10(void)
{
    two_postures();
    (void)RobotMotion_next(m);
    say(RobotMotion_reset(m));
    (void)RobotMotion_setReverse(m, true);
    say(RobotMotion_reset(m));
}

static void rm11(void)
{
    two_postures();
    say(RobotPosture_getDegree(RobotMotion_next(m), 1));
    say(RobotPosture_getDegree(RobotMotion_next(m), 1));
    say(RobotPosture_getDegree(RobotMotion_next(m), 1));
    say(m->current);
}

static void rm12(void)
{
    two_postures();
    say(RobotPosture_getDegree(RobotMotion_get(m, 1), 1));
}

static void rm13(void)
{
    two_postures();
    say(RobotPosture_getDegree(RobotMotion_rget(m, 1), 1));
    say(RobotPosture_getDegree(RobotMotion_rget(m, 2), 1));
}

static void rm15(void)
{
    two_postures();
    RobotPosture_setDegree(p, 1, 15);
    say(RobotMotion_insertPosture(m, RobotPosture_dupPosture(p), 1));
    say_motion(m);
}

static void rm16(void)
{
    two_postures();
    RobotMotion_deletePosture(m, 0);
    say_motion(m);
}

static void rm17(void)
{
    say(RobotMotion_loadMotionFromFile(m, in_folder("a.m")));
    say_motion(m);
}

static void rm18(void)
{
    two_postures();
    say(RobotMotion_saveMotionToFile(m, in_folder("b.m")));
    say_file(in_folder("b.m"));
}

static void rm19(void)
{
    two_postures();
    (void)RobotMotion_saveMotionToFile_dir(m, "c", in_folder(""));
    say(RobotMotion_saveMotionToFile_dir(m, "c", in_folder("")));
    say_file(in_folder("c0.m"));
    say_file(in_folder("c1.m"));
}

static void rm20(void)
{
    say(RobotMotion_loadMotionFromMseqFile(m, in_folder("a.mseq"), g));
    say_motion(m);
}

static void rm21(void)
{
    say(RobotMotion_loadMotionFromPseqFile(m, in_folder("a.pseq"), g));
    say_motion(m);
}

static void rm22(void)
{
    say(RobotMotion_loadMotionFromYamlFile(m, in_folder("a.yaml"), g));
    say_motion(m);
}

static void rm27(void)
{
    two_postures();
    RobotMotion_clear(m);
    say(RobotMotion_getSize(m));
    (void)RobotMotion_appendPosture(m, RobotPosture_dupPosture(p));
    say_motion(m);
}

static void rm28(void)
{
    two_postures();
    RobotMotion n;
    RobotMotion_init(&n);
    (void)RobotMotion_appendMotion(&n, m);
    say_motion(&n);
    RobotMotion_deinit(&n);
}

static void rm29(void)
{
    two_postures();
    RobotMotion *n = RobotMotion_dupMotion(m);
    say_motion(n);
    say(n->numJoints);
    RobotMotion_delete(n);
}

static const statement statements[] = {
    /* clang-format off */
    {"FN01", fn01,
     "say(rad2deg(0.2)); say(rad2deg(-3.2));",
     NULL,
     NULL},
    {"FN02", fn02,
     "say(deg2rad(90));",
     NULL,
     NULL},
    {"RP04", rp04,
     "RobotPosture z(20); say(z.motionTime);",
     "said 100",
     "100 ms is the document's"},
    {"RP07", rp07,
     "p->setDegree(4, 33); q = p->dupPosture(); p->setDegree(4, 0); "
     "say_posture(q);",
     NULL,
     NULL},
    {"RP08", rp08,
     "say(p->setMotionTime(120)); say(p->motionTime);",
     NULL,
     NULL},
    {"RP09", rp09,
     "p->setDegree(3, 155); say(p->getDegree(3)); say(p->jointAngles[2]); "
     "say(p->getDegree(0)); say(p->getDegree(21));",
     NULL,
     NULL},
    {"RP10", rp10,
     "p->setRad(2, 0.5); say(p->getRad(2)); say(p->getRad(21));",
     "said 0.499164 -10000",
     "radians are those of 0.1 degree"},
    {"RP15", rp15,
     "p->setDegree(5, 50); q->setDegree(5, 7); q->copyPosture(p); say_posture(q); "
     "say_posture(p);",
     NULL,
     NULL},
    {"RP16", rp16,
     "p->setDegree(1, 50); p->setDegree(2, 60); q->copyPosture(p, 3); "
     "say_posture(q);",
     NULL,
     NULL},
    {"RP17", rp17,
     "p->setDegree(6, 61); say(p->getJointAngles()[5]);",
     NULL,
     NULL},
    {"RP18", rp18,
     "p->setDegree(6, 90); say(p->getJointAnglesRad()[5]);",
     "said 0.15708",
     "its radians are ten times as large"},
    {"RP19", rp19,
     "say(p->equalTo(q)); q->setDegree(20, 1); say(p->equalTo(q)); "
     "say(p->equalTo(NULL));",
     NULL,
     NULL},
    {"RP20", rp20,
     "q->setDegree(20, 4); say(p->nearTo(q, 5)); say(p->nearTo(q, 3)); "
     "say(p->nearTo(q, 4));",
     "said 1 0 0",
     "the document says smaller"},
    {"RM08", rm08,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "say(m->getSize()); say(m->motion[1]->getDegree(1));",
     NULL,
     NULL},
    {"RM09", rm09,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "say(m->setReverse(true)); say(m->next()->getDegree(1)); "
     "say(m->next()->getDegree(1)); say(m->next()->getDegree(1));",
     NULL,
     NULL},
    {"RM10", rm10,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "m->next(); say(m->reset()); m->setReverse(true); say(m->reset());",
     NULL,
     NULL},
    {"RM11", rm11,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "say(m->next()->getDegree(1)); say(m->next()->getDegree(1)); "
     "say(m->next()->getDegree(1)); say(m->current);",
     NULL,
     NULL},
    {"RM12", rm12,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "say(m->get(1)->getDegree(1));",
     NULL,
     NULL},
    {"RM13", rm13,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "say(m->rget(1)->getDegree(1)); say(m->rget(2)->getDegree(1));",
     NULL,
     NULL},
    {"RM15", rm15,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "p->setDegree(1, 15); say(m->insertPosture(p->dupPosture(), 1)); "
     "say_motion(m);",
     NULL,
     NULL},
    {"RM16", rm16,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "m->deletePosture(0); say_motion(m);",
     NULL,
     NULL},
    {"RM17", rm17,
     "say(m->loadMotionFromFile(in_folder(\"a.m\"))); say_motion(m);",
     NULL,
     NULL},
    {"RM18", rm18,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "say(m->saveMotionToFile(in_folder(\"b.m\"))); say_file(in_folder(\"b.m\"));",
     NULL,
     NULL},
    {"RM19", rm19,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "m->saveMotionToFile(\"c\", in_folder(\"\")); say(m->saveMotionToFile(\"c\", "
     "in_folder(\"\"))); say_file(in_folder(\"c0.m\")); "
     "say_file(in_folder(\"c1.m\"));",
     NULL,
     NULL},
    {"RM20", rm20,
     "g->currentPosture->setDegree(1, 0); for (int i = 1; i <= 20; i++) "
     "g->currentPosture->setDegree(i, 0); "
     "say(m->loadMotionFromMseqFile(in_folder(\"a.mseq\"), g)); say_motion(m);",
     NULL,
     NULL},
    {"RM21", rm21,
     "for (int i = 1; i <= 20; i++) g->currentPosture->setDegree(i, 0); "
     "say(m->loadMotionFromPseqFile(in_folder(\"a.pseq\"), g)); say_motion(m);",
     NULL,
     NULL},
    {"RM22", rm22,
     "say(m->loadMotionFromYamlFile(in_folder(\"a.yaml\"), g)); say_motion(m);",
     NULL,
     NULL},
    {"RM27", rm27,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "m->clear(); say(m->getSize()); m->appendPosture(p->dupPosture()); "
     "say_motion(m);",
     NULL,
     NULL},
    {"RM28", rm28,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "RobotMotion n; n.appendMotion(m); say_motion(&n); n.motion.clear();",
     NULL,
     NULL},
    {"RM29", rm29,
     "p->setDegree(1, 10); q->setDegree(1, 20); "
     "m->appendPosture(p->dupPosture()); m->appendPosture(q->dupPosture()); "
     "RobotMotion *n = m->dupMotion(); say_motion(n); say(n->numJoints);",
     NULL,
     NULL},
    /* clang-format on */
};

TEST_EACH(statement, statements, what_leaves_is_what_the_original_sends)
{
    classic_begin();
    classic_judge(row);
}

int main(int argc, char **argv)
{
    return classic_main(argc, argv, statements, sizeof statements / sizeof statements[0]);
}
