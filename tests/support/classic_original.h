/* SPDX-License-Identifier: MIT */
/*
 * What the original library (n-ando/g-robot, libgrobot, commit 446ed31) sends and gives for the
 * statements of test_classic_data.c and test_classic_frames.c, in the words of frame_words.h.
 * Measured by tests/export/classic.sh with its sources and a simulated robot.
 * Beside each file that it reads was an empty one whose name has a dot more: it looks for that, and
 * finds it without on Windows alone.
 */
#ifndef GROBO_TESTS_CLASSIC_ORIGINAL_H
#define GROBO_TESTS_CLASSIC_ORIGINAL_H

/* The motion files of the statements. */
#define CLASSIC_FILE_M                                                                             \
    "100  0 10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"                                              \
    "250  0 20 30 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"                                             \
    "450  0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"

#define CLASSIC_FILE_MSEQ                                                                          \
    "type: MotionSeq\n"                                                                            \
    "name: \"a\"\n"                                                                                \
    "refs:\n"                                                                                      \
    "  -\n"                                                                                        \
    "    time: 1\n"                                                                                \
    "    refer:\n"                                                                                 \
    "      type: Motion\n"                                                                         \
    "      name: \"\"\n"                                                                           \
    "      joints: [ 1, 13 ]\n"                                                                    \
    "      q: [ 0.0873, -0.1746 ]\n"                                                               \
    "  -\n"                                                                                        \
    "    time: 3\n"                                                                                \
    "    refer:\n"                                                                                 \
    "      type: Motion\n"                                                                         \
    "      name: \"\"\n"                                                                           \
    "      joints: [ 13 ]\n"                                                                       \
    "      q: [ 0.0873 ]\n"

#define CLASSIC_FILE_PSEQ                                                                          \
    "type: PoseSeq\n"                                                                              \
    "name: \"a\"\n"                                                                                \
    "refs:\n"                                                                                      \
    "  -\n"                                                                                        \
    "    time: 1\n"                                                                                \
    "    refer:\n"                                                                                 \
    "      type: Pose\n"                                                                           \
    "      name: \"\"\n"                                                                           \
    "      joints: [ 1, 13 ]\n"                                                                    \
    "      q: [ 0.0873, -0.1746 ]\n"                                                               \
    "  -\n"                                                                                        \
    "    time: 3\n"                                                                                \
    "    refer:\n"                                                                                 \
    "      type: Pose\n"                                                                           \
    "      name: \"\"\n"                                                                           \
    "      joints: [ 13 ]\n"                                                                       \
    "      q: [ 0.0873 ]\n"

#define CLASSIC_FILE_YAML                                                                          \
    "type: BodyMotion\n"                                                                           \
    "components:\n"                                                                                \
    "  -\n"                                                                                        \
    "    type: MultiValueSeq\n"                                                                    \
    "    purpose: JointPosition\n"                                                                 \
    "    frameRate: 10\n"                                                                          \
    "    numParts: 20\n"                                                                           \
    "    numFrames: 2\n"                                                                           \
    "    frames:\n"                                                                                \
    "      - [ 0.0873, 0.1746, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 ]\n"           \
    "      - [ 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -0.1746, 0, 0, 0, 0, 0, 0 ]\n"

/* clang-format off */
static const struct {
    const char *name, *told;
} classic_original[] = {
    {"FN01",
     "said 11 -183"},
    {"FN02",
     "said 1.5708"},
    {"RP04",
     "said 250"},
    {"RP07",
     "said 0 0 0 33 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"},
    {"RP08",
     "said 120 120"},
    {"RP09",
     "said 155 155 -10000 -10000"},
    {"RP10",
     "said 0.5 -10000"},
    {"RP11",
     "goals 20 in 40: 2=200"},
    {"RP12",
     "goals 20 in 20:"},
    {"RP15",
     "said 0 0 0 0 50 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 50 0 0 0 0 0 0 0 0 0 0 0 "
     "0 0 0 0"},
    {"RP16",
     "said 0 0 0 50 60 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"},
    {"RP17",
     "said 61"},
    {"RP18",
     "said 1.5708"},
    {"RP19",
     "said 1 0 0"},
    {"RP20",
     "said 1 0 1"},
    {"RM08",
     "said 2 20"},
    {"RM09",
     "said 1 20 10 20"},
    {"RM10",
     "said 0 1"},
    {"RM11",
     "said 10 20 10 1"},
    {"RM12",
     "said 20"},
    {"RM13",
     "said 20 10"},
    {"RM15",
     "said 1 100 10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 100 15 0 0 0 0 0 0 0 0 0 0 "
     "0 0 0 0 0 0 0 0 0 100 20 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"},
    {"RM16",
     "said 100 20 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"},
    {"RM17",
     "said 1 100 0 10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 150 0 20 30 0 0 0 0 0 0 0 0 "
     "0 0 0 0 0 0 0 0 0 200 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"},
    {"RM18",
     "said 1 100  10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n200  20 0 0 0 0 0 0 0 0 0 "
     "0 0 0 0 0 0 0 0 0 0\n"},
    {"RM19",
     "said 1 100  10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n200  20 0 0 0 0 0 0 0 0 0 "
     "0 0 0 0 0 0 0 0 0 0\n 100  10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n200  20 0 "
     "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"},
    {"RM20",
     "said 1 1000 0 -100 0 0 0 0 0 0 0 0 50 0 0 0 0 0 0 0 0 0 2000 0 -50 0 0 0 0 0 0 "
     "0 0 50 0 0 0 0 0 0 0 0 0"},
    {"RM21",
     "said 1 1000 0 -100 0 0 0 0 0 0 0 0 50 0 0 0 0 0 0 0 0 0 2000 0 50 0 0 0 0 0 0 0 "
     "0 50 0 0 0 0 0 0 0 0 0"},
    {"RM22",
     "said 1 100 0 0 0 0 0 0 0 0 50 0 100 0 0 0 0 0 0 0 0 0 100 0 -100 0 0 0 0 0 0 0 "
     "0 0 0 0 0 0 0 0 0 0 0"},
    {"RM27",
     "said 0 100 10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"},
    {"RM28",
     "said 100 10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 100 20 0 0 0 0 0 0 0 0 0 0 0 "
     "0 0 0 0 0 0 0 0"},
    {"RM29",
     "said 100 10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 100 20 0 0 0 0 0 0 0 0 0 0 0 "
     "0 0 0 0 0 0 0 0 20"},
    {"SR28",
     "goals 20 in 20: 2=30"},
    {"SR29",
     "goals 20 in 90: 3=200 5=-200 6=-200 8=200 10=200 12=-400 13=-200 16=-200 18=400 "
     "19=200"},
    {"SR32",
     "said 3 100 0 10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 150 0 20 30 0 0 0 0 0 0 0 0 "
     "0 0 0 0 0 0 0 0 0 200 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 -1 0"},
    {"SR33",
     "said 3"},
    {"SR34",
     "said 2"},
    {"SR35",
     "said 2"},
    {"SR36",
     "said 2"},
    {"SR37",
     "said 3 100  0 10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n250  0 20 30 0 0 0 0 0 0 "
     "0 0 0 0 0 0 0 0 0 0 0\n450  0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"},
    {"SR40",
     "goals 20 in 40: 2=200 | said 0"},
    {"SR41",
     "goals 20 in 70: | said 0"},
    {"SR43",
     "goals 20 in 35: | said 350 350"},
    {"SR47",
     "said 2"},
    {"SR49",
     "sent check | said 2 1 7"},
    {"SR53",
     "said 0 10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 20 30 0 0 0 0 0 0 0 0 0 0 0 0 0 "
     "0 0 0 0"},
    {"SR54",
     "goals 20 in 30: 2=20 3=30"},
    {"SR57",
     "said 0 10 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 "
     "0 0 0"},
    {"SR60",
     "goals 20 in 30: 2=10; goals 20 in 15: 2=20 3=30; goals 20 in 20: | said 1"},
    {"SR60_twice",
     "goals 20 in 30: 2=10; goals 20 in 15: 2=20 3=30; goals 20 in 20:; goals 20 in "
     "30: 2=10; goals 20 in 15: 2=20 3=30; goals 20 in 20:"},
    {"SR60_reverse",
     "said throws"},
    {"SR63",
     "said 1"},
    {"SR64",
     "sent check | said 0"},
    {"SR65",
     "goals 20 in 30: 9=-50 | said -50 20 -20"},
    {"SR66",
     "said 1"},
    {"SR67",
     "said 0 0 0 0 0 0 0 0 0 0 0 20 0 0 0 0 0 -20 0 0"},
    {"SR70",
     "said 11 9 8"},
    {"SR71",
     "said 0 1 0"},
    {"GR18",
     "torque 9=0 | said 0"},
    {"GR18_on",
     "torque 9=1 | said 0"},
    {"GR19_0",
     "torque 1=1 2=1 3=1 4=1 5=1 6=1 7=1 8=1 9=1 10=1 11=1 12=1 13=1 14=1 15=1 16=1 "
     "17=1 18=1 19=1 20=1"},
    {"GR19_1",
     "torque 1=1 2=1 3=0 4=0 5=0 6=0 7=0 8=0 9=0 10=0 11=0 12=0 13=0 14=0 15=0 16=0 "
     "17=0 18=0 19=0 20=0"},
    {"GR19_2",
     "torque 1=0 2=0 3=1 4=1 5=1 6=0 7=0 8=0 9=0 10=0 11=0 12=0 13=0 14=0 15=0 16=0 "
     "17=0 18=0 19=0 20=0"},
    {"GR19_3",
     "torque 1=0 2=0 3=0 4=0 5=0 6=1 7=1 8=1 9=0 10=0 11=0 12=0 13=0 14=0 15=0 16=0 "
     "17=0 18=0 19=0 20=0"},
    {"GR19_4",
     "torque 1=0 2=0 3=1 4=1 5=1 6=1 7=1 8=1 9=0 10=0 11=0 12=0 13=0 14=0 15=0 16=0 "
     "17=0 18=0 19=0 20=0"},
    {"GR19_5",
     "torque 1=0 2=0 3=0 4=0 5=0 6=0 7=0 8=0 9=1 10=1 11=1 12=1 13=1 14=1 15=0 16=0 "
     "17=0 18=0 19=0 20=0"},
    {"GR19_6",
     "torque 1=0 2=0 3=0 4=0 5=0 6=0 7=0 8=0 9=0 10=0 11=0 12=0 13=0 14=0 15=1 16=1 "
     "17=1 18=1 19=1 20=1"},
    {"GR19_7",
     "torque 1=0 2=0 3=0 4=0 5=0 6=0 7=0 8=0 9=1 10=1 11=1 12=1 13=1 14=1 15=1 16=1 "
     "17=1 18=1 19=1 20=1"},
    {"GR20",
     "said 0"},
    {"GR21",
     "said 1 -124 3 10 0"},
    {"GR22",
     "goals 1 in 40: 9=-100"},
    {"GR23",
     "goals 20 in 30: 2=20 3=30 | said 0"},
    {"GR24",
     "goals 20 in 50: 1=50 4=30 | said 0"},
    {"GR25",
     "sent play M3 | said 1"},
    {"GR26",
     "sent play S2 | said 1"},
    {"GR28",
     "said 0.349066"},
    {"GR29",
     "goals 20 in 30: 1=5 | said 0"},
    {"GR30",
     "said 11 2"},
    {"GR31",
     "said 13"},
    {"GR33",
     "said 0 0"},
    {"GR34",
     "said 0 0 0 0 0 0 0 0 0 0 0 0 20 0 0 0 0 0 -20 0 0"},
    {"GR35",
     "goals 20 in 30:; goals 20 in 20: 2=20 | said 0"},
    {"GR36",
     "torque 1=1 2=1 3=1 4=1 5=1 6=1 7=1 8=1 9=1 10=1 11=1 12=1 13=1 14=1 15=1 16=1 "
     "17=1 18=1 19=1 20=1 | said 1"},
    {"GR38",
     "said 0.349066 0"},
    {"GR39",
     "goals 20 in 30:"},
    {"GR41",
     "goals 20 in 30: 2=40"},
};
/* clang-format on */

#endif
