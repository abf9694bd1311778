/* SPDX-License-Identifier: MIT */
#include "body_pseq.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

static yaml_node_t *field(yaml_document_t *doc, yaml_node_t *node, const char *name)
{
    if (node == NULL || node->type != YAML_MAPPING_NODE) {
        return NULL;
    }
    for (yaml_node_pair_t *pair = node->data.mapping.pairs.start;
         pair < node->data.mapping.pairs.top; pair++) {
        yaml_node_t *key = yaml_document_get_node(doc, pair->key);

        if (strcmp((const char *)key->data.scalar.value, name) == 0) {
            return yaml_document_get_node(doc, pair->value);
        }
    }
    return NULL;
}

static const char *text_of(yaml_node_t *node)
{
    return node != NULL && node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value
                                                          : "";
}

static double number(yaml_node_t *node)
{
    return strtod(text_of(node), NULL);
}

static bool flag(yaml_document_t *doc, yaml_node_t *node, const char *name)
{
    return strcmp(text_of(field(doc, node, name)), "true") == 0;
}

static size_t length(yaml_node_t *node)
{
    return node == NULL || node->type != YAML_SEQUENCE_NODE
               ? 0
               : (size_t)(node->data.sequence.items.top - node->data.sequence.items.start);
}

static yaml_node_t *item(yaml_document_t *doc, yaml_node_t *node, size_t i)
{
    return yaml_document_get_node(doc, node->data.sequence.items.start[i]);
}

static bool numbers(yaml_document_t *doc, yaml_node_t *node, double *out, size_t n)
{
    for (size_t i = 0; i < n && i < length(node); i++) {
        out[i] = number(item(doc, node, i));
    }
    return length(node) == n;
}

static void read_targets(yaml_document_t *doc, yaml_node_t *list, grobo_body_key *key,
                         const grobo_body_model *model)
{
    grobo_body_target *targets = calloc(length(list) + 1, sizeof *targets);

    for (size_t i = 0; i < length(list); i++) {
        yaml_node_t *node = item(doc, list, i);
        grobo_body_target *target = &targets[i];
        const char *name = text_of(field(doc, node, "name"));

        target->link = -1;
        for (int k = 0; k < model->n_links; k++) {
            target->link = strcmp(model->links[k].name, name) == 0 ? k : target->link;
        }
        numbers(doc, field(doc, node, "translation"), target->at.p_m, 3);
        numbers(doc, field(doc, node, "rotation"), target->at.r, 9);
        target->base = flag(doc, node, "isBaseLink");
        target->stationary = flag(doc, node, "isStationaryPoint");
        target->touching = flag(doc, node, "isTouching");
        target->slave = flag(doc, node, "isSlave");
    }
    key->targets = targets;
    key->n_targets = length(list);
}

static void read_ref(yaml_document_t *doc, yaml_node_t *ref, grobo_body_key *key,
                     const grobo_body_model *model)
{
    yaml_node_t *pose = field(doc, ref, "refer");
    yaml_node_t *joints = field(doc, pose, "joints");
    yaml_node_t *still = field(doc, pose, "spJoints");
    double *q = calloc(GROBO_JOINTS_MAX, sizeof *q);

    key->time_s = number(field(doc, ref, "time"));
    key->max_transition_s = number(field(doc, ref, "maxTransitionTime"));
    for (size_t i = 0; i < length(joints); i++) {
        const int j = (int)number(item(doc, joints, i));

        key->joints |= GROBO_JOINT_BIT(j);
        q[j] = number(item(doc, field(doc, pose, "q"), i));
    }
    for (size_t i = 0; i < length(still); i++) {
        key->stationary |= GROBO_JOINT_BIT((int)number(item(doc, still, i)));
    }
    key->q_rad = q;
    read_targets(doc, field(doc, pose, "ikLinks"), key, model);
    key->has_zmp = numbers(doc, field(doc, pose, "zmp"), key->zmp_m, 3);
    key->zmp_stationary = flag(doc, pose, "isZmpStationaryPoint");
}

bool body_pseq_read(struct body_pseq *pseq, const char *path, const grobo_body_model *model)
{
    FILE *file = fopen(path, "rb");
    yaml_parser_t parser;
    yaml_document_t doc;
    bool good = false;

    memset(pseq, 0, sizeof *pseq);
    if (file == NULL) {
        return false;
    }
    if (yaml_parser_initialize(&parser)) {
        yaml_parser_set_input_file(&parser, file);
        if (yaml_parser_load(&parser, &doc)) {
            yaml_node_t *refs = field(&doc, yaml_document_get_root_node(&doc), "refs");

            pseq->n_keys = length(refs);
            pseq->keys = calloc(pseq->n_keys + 1, sizeof *pseq->keys);
            for (size_t i = 0; i < pseq->n_keys; i++) {
                read_ref(&doc, item(&doc, refs, i), &pseq->keys[i], model);
            }
            good = pseq->n_keys > 0;
            yaml_document_delete(&doc);
        }
        yaml_parser_delete(&parser);
    }
    fclose(file);
    return good;
}

void body_pseq_free(struct body_pseq *pseq)
{
    for (size_t i = 0; i < pseq->n_keys; i++) {
        free((void *)pseq->keys[i].targets);
        free((void *)pseq->keys[i].q_rad);
    }
    free(pseq->keys);
}
