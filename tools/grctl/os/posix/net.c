/* SPDX-License-Identifier: MIT */
#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>

#include "tools/grctl/os/net.h"

uint16_t net_port(evutil_socket_t fd)
{
    struct sockaddr_storage at;
    socklen_t size = sizeof at;
    memset(&at, 0, sizeof at);
    if (getsockname(fd, (struct sockaddr *)&at, &size) < 0) {
        return 0;
    }
    return ntohs(at.ss_family == AF_INET6 ? ((const struct sockaddr_in6 *)&at)->sin6_port
                                          : ((const struct sockaddr_in *)&at)->sin_port);
}

int net_is_loopback(const char *address)
{
    return strncmp(address, "127.", 4) == 0 || strcmp(address, "::1") == 0 ||
           strncmp(address, "::ffff:127.", 11) == 0;
}

/* Address and port at the other end; the port is 0 where they are not known. */
static uint16_t peer_of(evutil_socket_t fd, char *text, size_t capacity)
{
    struct sockaddr_storage from;
    socklen_t size = sizeof from;
    uint16_t port = 0;
    memset(&from, 0, sizeof from);
    *text = '\0';
    if (getpeername(fd, (struct sockaddr *)&from, &size) < 0) {
        return 0;
    }
    if (from.ss_family == AF_INET6) {
        const struct sockaddr_in6 *six = (const struct sockaddr_in6 *)&from;
        inet_ntop(AF_INET6, &six->sin6_addr, text, (socklen_t)capacity);
        port = ntohs(six->sin6_port);
    } else if (from.ss_family == AF_INET) {
        const struct sockaddr_in *four = (const struct sockaddr_in *)&from;
        inet_ntop(AF_INET, &four->sin_addr, text, (socklen_t)capacity);
        port = ntohs(four->sin_port);
    }
    return port;
}

void net_peer(evutil_socket_t fd, char *text, size_t capacity)
{
    (void)peer_of(fd, text, capacity);
    if (net_is_loopback(text)) {
        *text = '\0';
    }
}

bool net_connection(evutil_socket_t fd, char *text, size_t capacity)
{
    uint16_t port = fd >= 0 ? peer_of(fd, text, capacity) : 0;
    size_t n = port ? strlen(text) : 0;
    text[n] = '\0';
    if (port != 0) {
        snprintf(text + n, capacity - n, " %u", (unsigned)port);
    }
    return port != 0;
}

void net_end(evutil_socket_t fd)
{
    (void)shutdown(fd, SHUT_RDWR);
}

void net_keep_little(evutil_socket_t fd, int bytes)
{
    (void)setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
}
