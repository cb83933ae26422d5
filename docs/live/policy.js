"use strict";
// What the page may reach: nothing; or, opened with ?ws=ws://..., that one WebSocket.

const WATCHED = (() => {
  const asked = new URLSearchParams(location.search).get("ws");
  if (asked === null) return null;
  try {
    const { protocol, host } = new URL(asked);
    return protocol === "ws:" || protocol === "wss:" ? `${protocol}//${host}` : "";
  } catch {
    return "";
  }
})();

document.head.append(Object.assign(document.createElement("meta"), {
  httpEquiv: "Content-Security-Policy",
  content: `connect-src ${WATCHED || "'none'"}; form-action 'none'; img-src data:`,
}));
