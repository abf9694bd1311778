/* SPDX-License-Identifier: MIT */
/* What libevent does not ask of sockets. */
#ifndef GRCTL_OS_NET_H
#define GRCTL_OS_NET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <event2/util.h>

/* The port at which a socket listens, 0: none. */
uint16_t net_port(evutil_socket_t fd);
/* The address at the other end; "" for this machine, and where it is not known. */
void net_peer(evutil_socket_t fd, char *text, size_t capacity);
/*
 * The connection of a socket, in words: address and port at its other end. The same socket number
 * has other words where it is another connection. False: there is none any more.
 */
bool net_connection(evutil_socket_t fd, char *text, size_t capacity);
/* True for an address of this machine alone. */
int net_is_loopback(const char *address);
/* Ends the connection for both sides; the socket stays. */
void net_end(evutil_socket_t fd);
/* How much of what was written the system keeps for a slow reader. */
void net_keep_little(evutil_socket_t fd, int bytes);

#endif
